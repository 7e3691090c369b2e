#include "client/experiment/screw/screw_subject.h"

#include <algorithm>
#include <utility>

#include "client/api/cursor_sender.h"
#include "server/base/units.h"
#include "server/lab/study/study_run.h"

namespace handrail {
namespace {

constexpr double kAgain = 0.5;     // until an order is made again [s]
constexpr double kHomeward = 1.0;  // bringing the hand back, the arm held [s]

pb::Request request_of(const ScrewKey& key) {
  pb::Request out;
  if (key.act == ScrewKey::Act::kToolsOff) {
    out.mutable_tool_off();
    return out;
  }
  pb::Tool& tool = *out.mutable_tool();
  switch (key.tool.kind) {
    case ToolKind::kNRotation: tool.set_kind(pb::Tool::N_ROTATION); break;
    case ToolKind::kFRotation: tool.set_kind(pb::Tool::F_ROTATION); break;
    default:
      tool.set_kind(pb::Tool::LINE);
      for (const double value : key.tool.p_SA) tool.add_at_mm(value / kMm);
      for (const double value : key.tool.direction_S) tool.add_direction(value);
  }
  return out;
}

}  // namespace

ScrewSubject::ScrewSubject(const Scene& scene, const OperatorParameters& person, std::uint64_t seed)
    : scene_(scene),
      work_(scene),
      person_(person),
      seed_(seed),
      hand_(hand_options(person, seed)) {}

void ScrewSubject::begin(ScrewMode mode, int number) {
  trial_.reset();
  mind_works_.reset();
  orders_.clear();
  mode_ = mode;
  number_ = number;
  const OperatorMachine machine{.scale = scene_.mapping.scale, .q_SM = Quat(scene_.mapping.R_SM)};
  mind_.emplace(person_, machine, seed_of(seed_, 1, static_cast<std::uint64_t>(number)));
}

std::optional<ScrewPhase> ScrewSubject::phase() const {
  return mind_works_ ? std::optional(mind_works_->phase()) : std::nullopt;
}

// One tick of the hand and of what is thought.
void ScrewSubject::live(bool thinks) {
  const double dt = to_seconds(kHandStep);
  credit_ -= kHandStep;
  now_ += dt;
  if (thinks) mind_->step(dt, rig_.seen(), told_.f_H_M, hand_);
  // The device has the hand's compliance: here it only means.
  hand_.step(dt, Wrench{});
}

std::vector<pb::Request> ScrewSubject::act(Nanos now, const ScrewTold& told, const RigSight& rig,
                                           ScrewLive::Stage stage) {
  told_ = told;
  rig_ = rig;
  stage_ = stage;
  if (last_ < 0) {
    hand_.place(told.X_MH.p);
    last_ = now;
  }
  credit_ += std::min(now - last_, kLongestHandStep);
  last_ = now;
  const bool held_up = !orders_.empty();  // by an order that was refused
  if (told.drives && !held_up) {
    if (!trial_ && stage == ScrewLive::Stage::kReady)
      trial_ = std::make_unique<StepThread>([this](StepThread&) { make_trial(); });
    if (trial_) trial_->resume();
  }
  while (credit_ >= kHandStep) live(false);
  if (!told.drives && now_ >= due_) {
    due_ = now_ + kAgain;
    pb::Request request;
    told.fault ? request.set_reset(true) : request.set_engage(true);
    return {request};
  }
  if (!told.drives || (held_up && now_ < due_)) return {};
  return std::exchange(orders_, {});
}

void ScrewSubject::refused(const pb::Request& request) {
  if (!request.has_tool() && !request.has_tool_off() && !request.has_clutch()) return;
  orders_.push_back(request);
  due_ = now_ + kAgain;
}

void ScrewSubject::make_trial() {
  HandIntent home;
  home.home = true;
  home.duration = kHomeward;
  hand_.steer(home);
  for (const double until = now_ + 1.5 * kHomeward; now_ < until;) {
    if (!pass({})) return;
  }
  TrialPlan<ScrewMode> plan;
  plan.person = person_;
  plan.number = number_;
  ScrewPlace& here = *this;
  mind_works_.emplace(here, work_, Compliance(*scene_.simulate), person_,
                      ScrewHabits{has_tools(mode_), pause_of(plan), to_seconds(kHandStep)});
  mind_works_->fasten();
}

bool ScrewSubject::pass(const ScrewKey& key) {
  if (key.act != ScrewKey::Act::kNone) orders_.push_back(request_of(key));
  // What is ordered is to be so before anything else happens.
  while (credit_ < kHandStep || !orders_.empty()) {
    if (!trial_->pause()) return false;
  }
  live(true);
  return true;
}

void ScrewSubject::start_clock() {
  double marks_at = now_;
  while (stage_ != ScrewLive::Stage::kTimed) {
    if (now_ >= marks_at) {
      marks_at = now_ + kAgain;
      pb::Request mark;
      mark.set_mark("simulated");
      orders_.push_back(mark);
    }
    if (!pass({})) return;
  }
  pb::Request open;
  open.set_clutch(false);
  orders_.push_back(open);
}

}  // namespace handrail
