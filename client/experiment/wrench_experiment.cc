#include "client/experiment/wrench_experiment.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/units.h"

namespace handrail {
namespace {

// Our choices.
constexpr double kAtBall = 5e-3;   // less than half of the aisle [m]
constexpr double kHeldFor = 1.0;   // before the ball sets out [s]
constexpr double kLoose = 0.05;    // what a hand at the aisle's end turns by chance [rad]
constexpr double kAskAgain = 1.0;  // [s]

double c_of(const Scene& scene) {
  const EffectSpec* friction = effect_of(scene, EffectKind::kProgressive);
  return friction == nullptr ? 0.0 : friction->c;
}

}  // namespace

WrenchExperiment::WrenchExperiment(const Scene& scene, const WrenchPath& path, WrenchWay way)
    : WallTask(scene, {}),
      path_(path),
      loosen_(way == WrenchWay::kTightenAndLoosen ? kWrenchLoops : 0),
      wanted_c_(way == WrenchWay::kTightenAndLoosen ? kLooseningC : c_of(scene)),
      ball_(path, kWrenchLoops, loosen_) {}

void WrenchExperiment::restart() {
  ball_ = GuidingBall(path_, kWrenchLoops, loosen_);
  loose_ = ready_ = refused_ = false;
  there_since_.reset();
  now_ = turned_ = c_ = most_off_ = sum_ = 0.0;
  seen_ = 0;
}

void WrenchExperiment::act(const pb::Status& now, const TaskHelp& help) {
  c_ = now.walls().screw_c();
  ready_ = loose_ && c_ == wanted_c_;
  if (!ready_ && !timed() && now.time_s() >= again_at_) {
    again_at_ = now.time_s() + kAskAgain;
    pb::Request wanted;
    if (!loose_) {
      wanted.set_scene_load(scene().name);
    } else {
      wanted.set_screw_c(wanted_c_);
    }
    const Status done = help.order(wanted);
    if (!done && !refused_) help.say("  the screw is not made ready: " + done.message());
    refused_ = !done;
  }
  WallTask::act(now, help);
}

void WrenchExperiment::watch(const WallTick& now) {
  turned_ = now.turned;
  if (!timed()) {
    loose_ = std::abs(now.turned) < kLoose;
    const bool there = ready_ && held() && (now.hand - ball_.p()).norm() < kAtBall;
    if (!there) return there_since_.reset();
    if (!there_since_) there_since_ = now.t;
    if (now.t - *there_since_ >= kHeldFor) start_clock(now.t);
    return;
  }
  now_ = since_start(now.t);
  ball_.move(now_, now.hand);
  const double off = (now.hand - ball_.p()).norm();
  most_off_ = std::max(most_off_, off);
  sum_ += off;
  ++seen_;
  if (now_ >= ball_.duration() && ball_.left() < kAtBall) end(TrialEnd::kDone, now.t);
}

std::string WrenchExperiment::words() const {
  if (!timed()) {
    if (!ready_) return "The screw is being made ready.";
    return there_since_ ? "The ball sets out in a second: follow it."
                        : "Bring the lever to the ball.";
  }
  const int loop = std::clamp(ball_.loop(now_) + 1, 1, kWrenchLoops + loosen_);
  const bool back = loop > kWrenchLoops;
  return fmt::format("Follow the ball{}: loop {} of {}.", back ? " back" : "",
                     back ? loop - kWrenchLoops : loop, kWrenchLoops);
}

WallTask::Aim WrenchExperiment::aim(const WallTick&) { return {ball_.p(), ball_.v()}; }

void WrenchExperiment::measure(pb::WallTrial& out) const {
  out.set_max_from_ball_mm(most_off_ / kMm);
  if (seen_ > 0) out.set_mean_from_ball_mm(sum_ / seen_ / kMm);
  out.set_turned_rad(turned_);
  out.set_screw_c(c_);
}

std::string WrenchExperiment::measured() const {
  return fmt::format(
      "turned by {:.1f} rad, c = {:g} N s/(m rad), the hand {:.0f} mm from the ball "
      "at most",
      turned_, c_, most_off_ / kMm);
}

}  // namespace handrail
