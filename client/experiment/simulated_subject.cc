#include "client/experiment/simulated_subject.h"

#include <algorithm>
#include <cmath>

#include "client/api/cursor_sender.h"

namespace handrail {
namespace {

constexpr double kAgain = 0.5;     // until an order is made again [s]
constexpr double kHomeward = 1.0;  // bringing the hand back, the arm held [s]
constexpr int kCalls = 2;          // keys to a phase's tools

pb::Request named(const char* tool) {
  pb::Request request;
  request.set_named_tool(tool);
  return request;
}

pb::Request n_rotation() {
  pb::Request request;
  request.mutable_tool()->set_kind(pb::Tool::N_ROTATION);
  return request;
}

pb::Request off(bool position, bool orientation) {
  pb::Request request;
  request.mutable_tool_off()->set_position(position);
  request.mutable_tool_off()->set_orientation(orientation);
  return request;
}

pb::Request clutch_open() {
  pb::Request request;
  request.set_clutch(false);
  return request;
}

pb::Request mark() {
  pb::Request request;
  request.set_mark("simulated");
  return request;
}

std::vector<pb::Request> tools_of(LinearPhase phase) {
  switch (phase) {
    case LinearPhase::kToB: return {named("A-to-B"), n_rotation()};
    case LinearPhase::kTurn: return {named("at-B"), off(false, true)};
    case LinearPhase::kToC: break;
  }
  return {named("B-to-C"), n_rotation()};
}

}  // namespace

SimulatedSubject::SimulatedSubject(const Scene& scene, const OperatorParameters& person,
                                   std::uint64_t seed)
    : task_(*scene.task),
      person_(person),
      mind_(person, {.scale = scene.mapping.scale, .q_SM = Quat(scene.mapping.R_SM)}, seed + 1),
      hand_(hand_options(person, seed)) {}

void SimulatedSubject::begin(StudyMode mode, int number) {
  mode_ = mode;
  pause_ = person_.pause * std::pow(number, -person_.practice);
  stage_ = LinearLive::Stage::kEnded;
}

bool SimulatedSubject::due(double seconds) {
  if (now_ < acts_at_) return false;
  acts_at_ = now_ + seconds;
  return true;
}

void SimulatedSubject::live_on(Nanos now, const SubjectSight& sight) {
  if (last_ < 0) {
    hand_.place(sight.X_MH.p);
    last_ = now;
  }
  Nanos left = std::min(now - last_, kLongestHandStep);
  last_ = now;
  for (; left > 0; left -= kHandStep) {
    const double dt = to_seconds(std::min(left, kHandStep));
    now_ += dt;
    mind_.step(dt, sight.X_ST, sight.f_H_M, hand_);
    // The device has the hand's compliance: here it only means.
    hand_.step(dt, Wrench{});
  }
}

std::vector<pb::Request> SimulatedSubject::step(Nanos now, const SubjectSight& sight,
                                                const LinearLive& live) {
  live_on(now, sight);
  std::vector<pb::Request> orders;
  if (!sight.drives) {
    if (!due(kAgain)) return orders;
    pb::Request request;
    sight.fault ? request.set_reset(true) : request.set_engage(true);
    orders.push_back(request);
    return orders;
  }
  if (live.stage() != stage_) {
    stage_ = live.stage();
    called_ = aims_ = false;
    mind_.leave_off(hand_);
    begin_stage();
  }
  switch (stage_) {
    case LinearLive::Stage::kAtA:
      if (due(kAgain)) orders.push_back(mark());
      break;
    case LinearLive::Stage::kToA:
    case LinearLive::Stage::kEnded: break;
    default: act(live, orders);
  }
  return orders;
}

void SimulatedSubject::begin_stage() {
  acts_at_ = now_;
  if (stage_ == LinearLive::Stage::kAtA) {
    HandIntent home;
    home.home = true;
    home.duration = kHomeward;
    hand_.steer(home);
    acts_at_ += 1.5 * kHomeward;
  }
  if (stage_ < LinearLive::Stage::kToB) return;
  // The first decision was made before the clock started.
  if (stage_ != LinearLive::Stage::kToB) acts_at_ += pause_;
  if (mode_ == StudyMode::kTools) acts_at_ += person_.call_homing + kCalls * person_.call_key;
}

void SimulatedSubject::act(const LinearLive& live, std::vector<pb::Request>& orders) {
  const bool tools = mode_ == StudyMode::kTools;
  if (!aims_) {
    if (now_ < acts_at_) return;
    if (tools && !called_) {
      called_ = true;
      orders = tools_of(live.phase());
      return;
    }
    if (live.phase() == LinearPhase::kToB) orders.push_back(clutch_open());
    mind_.aim(aim_of(task_, live.phase(), tools));
    aims_ = true;
    acts_at_ = now_;
  }
  if (mind_.arrived() && due(kAgain)) orders.push_back(mark());
}

void SimulatedSubject::refused(const pb::Request& request) {
  if (!request.has_tool() && !request.has_named_tool()) return;
  called_ = false;
  acts_at_ = now_ + kAgain;
}

}  // namespace handrail
