#include "server/session/ladder.h"

#include <algorithm>

#include "server/base/deletable.h"

namespace handrail {
namespace {

constexpr double kFade = 0.1;  // of loop age beyond its limit [s]

bool heard(LinkRung rung) { return flowing(rung) || rung == LinkRung::kHold; }
bool poor(int received_of_100) { return grade_of(received_of_100) == LinkGrade::kPoor; }
double lost(int received_of_100) { return 1.0 - received_of_100 / 100.0; }

double share_of_force(const LadderSettings& settings, Nanos loop_age) {
  if (loop_age <= settings.fade_loop || !kept(Check::kLoopAge)) return 1.0;
  return std::max(0.0, 1.0 - to_seconds(loop_age - settings.fade_loop) / kFade);
}

}  // namespace

LinkRung rung_of(bool ever, Nanos age, const LinkView& link) noexcept {
  const LinkRung rung = rung_of(ever, age);
  const bool holds = poor(link.received_of_100) || poor(link.peer_received_of_100);
  return holds && flowing(rung) && kept(Check::kQuality) ? LinkRung::kHold : rung;
}

bool good_enough(const LinkShares& shares) noexcept {
  return shares.heard >= 1.0 && !too_much(std::max(shares.held, shares.peer_held), kMostHeld) &&
         !too_much(std::max(shares.lost, shares.peer_lost), kMostLost);
}

LadderStep ladder_step(const LadderSettings& settings, bool ever, Nanos age, const LinkView& link,
                       double elapsed, LadderState& state) noexcept {
  LadderStep step;
  step.rung = rung_of(ever, age, link);
  const LinkRung here = rung_of(ever, age), there = rung_of(ever, link.peer_age);
  if (!heard(here) || !heard(there)) {
    state.window = LinkWindow();
  } else if (settings.good_for > 0) {
    state.window.add({flowing(here) ? 0.0 : 1.0, flowing(there) ? 0.0 : 1.0,
                      lost(link.received_of_100), lost(link.peer_received_of_100)},
                     elapsed, to_seconds(settings.good_for));
  }
  step.shares = state.window.shares();
  step.good = settings.good_for == 0 || good_enough(step.shares) || !kept(Check::kQuality);
  step.old_loop = kept(Check::kLoopAge) && link.loop_age > settings.warn_loop;
  step.force_share = share_of_force(settings, link.loop_age);
  return step;
}

}  // namespace handrail
