#include "server/session/ladder.h"

#include <algorithm>

#include "server/base/deletable.h"

namespace handrail {
namespace {

constexpr double kFade = 0.1;     // of loop age beyond its limit [s]
constexpr double kLongest = 100;  // what `good` counts to [s]

bool good(LinkGrade grade) { return grade >= LinkGrade::kGood || !kept(Check::kQuality); }

double share_of_force(const LadderSettings& settings, Nanos loop_age) {
  if (loop_age <= settings.fade_loop || !kept(Check::kLoopAge)) return 1.0;
  return std::max(0.0, 1.0 - to_seconds(loop_age - settings.fade_loop) / kFade);
}

}  // namespace

LinkRung rung_of(bool ever, Nanos age, const LinkView& link) noexcept {
  const LinkRung rung = rung_of(ever, age);
  const bool poor = link.grade == LinkGrade::kPoor || link.peer_grade == LinkGrade::kPoor;
  const bool flowing = rung == LinkRung::kFresh || rung == LinkRung::kSlow;
  return poor && flowing && kept(Check::kQuality) ? LinkRung::kHold : rung;
}

LadderStep ladder_step(const LadderSettings& settings, bool ever, Nanos age, const LinkView& link,
                       double dt, LadderState& state) noexcept {
  LadderStep step;
  step.rung = rung_of(ever, age, link);
  const bool flowing = step.rung == LinkRung::kFresh || step.rung == LinkRung::kSlow;
  state.good = flowing && good(link.grade) && good(link.peer_grade)
                   ? std::min(state.good + dt, kLongest)
                   : 0.0;
  step.held_good = state.good >= to_seconds(settings.good_for);
  step.old_loop = kept(Check::kLoopAge) && link.loop_age > settings.warn_loop;
  step.force_share = share_of_force(settings, link.loop_age);
  return step;
}

}  // namespace handrail
