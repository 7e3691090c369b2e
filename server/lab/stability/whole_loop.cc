#include "server/lab/stability/whole_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/omni/omni_data.h"
#include "server/kinematics/arm_of.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;        // [s]
constexpr double kSensorRange = 1e3;  // [N]
constexpr int kOrderEvery = 100;      // while it does not engage, chosen [ticks]
constexpr double kShakeRate = 5.0;    // of a wrist, chosen [Hz]
constexpr double kShakeGone = 0.1;    // time constant [s]
constexpr double kShakeEnds = 0.5;    // [s]

HapticSettings settings_of(const Scene& scene) {
  HapticSettings out = haptic_settings(scene, omni_capabilities(false), true);
  out.ladder.good_for = kSecond;
  out.ladder.fade_loop = kForever;
  out.force.continuous = out.force.peak;
  return out;
}

std::unique_ptr<Cell> cell_of(const WholeLoopOptions& of, const HapticSettings& settings) {
  auto options = std::make_unique<CellOptions>();
  options->haptic = settings;
  options->follow = follow_settings(of.scene, options->rig.controller.period, true, kSensorRange);
  options->rig.controller.arm.geometry = arm_of(of.scene);
  options->rig.controller.arm.q_start = of.q_start;
  run_only_listed(of.scene, options->rig);
  options->rig.controller.arm.seed = of.seed;
  options->rig.sensor.seed = of.seed + 1;
  options->net = CellNetOptions{.seed = of.seed + 2,
                                .master_clock = of.counters.clock,
                                .slave_clock = of.counters.clock / 2,
                                .sequence = of.counters.sequence};
  options->epoch = of.counters.epoch;
  return std::make_unique<Cell>(*options);
}

DeviceBody omni_body() {
  const DeviceDynamics of = omni_capabilities(false).dynamics;
  return {of.mass, of.damping, of.friction};
}

}  // namespace

WholeLoop::WholeLoop(const WholeLoopOptions& options)
    : options_(options),
      settings_(settings_of(options.scene)),
      cell_(cell_of(options, settings_)),
      device_(omni_body(), options.grip, Vec2::Zero()),
      encoder_(kOmniResolution, kOmniVelocityCutoff),
      bounds_(settings_) {
  set(options.way);
}

void WholeLoop::set(const LinkFaults& way) noexcept {
  cell_->net()->link().to_slave().faults = cell_->net()->link().to_master().faults = way;
}

bool WholeLoop::engage(double patience) {
  const double until = t_ + patience;
  for (int i = 0; t_ < until && !engaged_; ++i) {
    HapticOrder order;
    if (i % kOrderEvery == 0) order.kind = OrderKind::kEngage;
    tick(order);
    if (cell_->master().order_result != Reason::kNone) why_ = cell_->master().order_result;
    engaged_ = cell_->master_state().lead.session == SessionState::kEngaged &&
               cell_->slave().state == SessionState::kEngaged;
  }
  tip_0_ = cell_->rig().true_tip().p;
  hand_0_ = encoder_.position();
  return engaged_;
}

void WholeLoop::lead(const Vec2& by, double seconds, const Vec3& turn_M) {
  const Vec3 from(way_.at(t_ - set_out_).p), turned(turning_.at(t_ - set_out_).p);
  way_ = MinJerk({from, Vec3::Zero(), Vec3::Zero()}, from + Vec3(by.x(), by.y(), 0.0), seconds);
  turning_ = MinJerk({turned, Vec3::Zero(), Vec3::Zero()}, turned + turn_M, seconds);
  set_out_ = t_;
}

HandReading WholeLoop::reading() {
  encoder_.read(device_.position(), kTick);
  HandReading out;
  out.X_MH.p = in_M(encoder_.position());
  out.v_MH = in_M(encoder_.velocity());
  Vec3 turn = turning_.at(t_ - set_out_).p;
  if (const double since = t_ - shaken_at_; since < kShakeEnds) {
    turn += std::exp(-since / kShakeGone) * std::sin(2.0 * std::numbers::pi * kShakeRate * since) *
            shake_;
  }
  out.X_MH.q = rotation_exp(turn);
  out.valid = true;
  return out;
}

void WholeLoop::tick(const HapticOrder& order) {
  const Vec3 meant = way_.at(t_ - set_out_).p;
  device_.lead({meant.x(), meant.y()});
  cell_->tick(reading(), order);
  cell_->net()->link().to_slave().clear_deliveries();
  cell_->net()->link().to_master().clear_deliveries();
  const Vec3& f_M = cell_->master().f_H_M.force;
  const Vec2 force(f_M.dot(options_.along_M), f_M.dot(options_.across_M));
  most_step_ = std::max(most_step_, (force - force_).norm());
  force_ = force;
  device_.advance(kTick, force_);
  t_ += kTick;
  bounds_.see(cell_->master_input(), kTick, cell_->master_state(), cell_->master());
  for (const Judged& one : bounds_.judged()) most_bound_ = std::max(most_bound_, one.ratio);
  measure();
  if (!engaged_) return;
  const LeadState& lead = cell_->master_state().lead;
  ++led_;
  held_ += lead.session == SessionState::kHold;
  if (!ended_ && (lead.session == SessionState::kOff || lead.session == SessionState::kFault)) {
    ended_ = true;
    why_ = lead.reason;
    ended_peer_ = lead.peer_fault;
  }
}

bool WholeLoop::pass(double seconds) {
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds / kTick));
  for (std::int64_t i = 0; i < ticks && !ended_; ++i) tick();
  return !ended_;
}

void WholeLoop::begin_window() noexcept {
  window_ = LoopWindow();
  given_0_ = device_.given() - device_.lost();
}

void WholeLoop::measure() {
  window_.hand.add(device_.position());
  const Mat3& R_SM = options_.scene.mapping.R_SM;
  const Vec3 tip = R_SM.transpose() * cell_->rig().true_tip().p;
  window_.tip.add({tip.dot(options_.along_M), tip.dot(options_.across_M)});
  window_.most_given = std::max(window_.most_given, device_.given() - device_.lost() - given_0_);
}

std::string WholeLoop::ended_by() const {
  if (!ended_) return {};
  const std::string out = std::string("ended: ") + describe(why_);
  return why_ == Reason::kPeerFault ? out + ": " + describe(ended_peer_) : out;
}

Vec3 WholeLoop::asked_at(const Vec2& hand) const {
  return tip_0_ +
         options_.scene.mapping.scale * (options_.scene.mapping.R_SM * in_M(hand - hand_0_));
}

}  // namespace handrail
