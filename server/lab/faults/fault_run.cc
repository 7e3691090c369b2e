#include "server/lab/faults/fault_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/omni/omni_data.h"
#include "server/base/in_32_bits.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"

namespace handrail {
namespace {

constexpr Nanos kPatience = 10 * kSecond;
// An operator's hand is on the keyboard this long after anything.
constexpr Nanos kOperatorDelay = 300 * kMillisecond;
constexpr Nanos kResumePatience = 500 * kMillisecond;

AuditLimits audit_limits() {
  const Scene scene = fault_scene({});
  AuditLimits limits;
  limits.joints = scene.limits.joints;
  limits.max_jerk = scene.limits.joints.max_jerk;
  limits.arm = arm_of(scene);
  limits.force = omni_capabilities(false).max_force;
  return limits;
}

}  // namespace

void find(FaultOutcome& outcome, std::uint64_t count, const char* what) {
  if (count == 0) return;
  outcome.violations += count;
  if (!outcome.found.empty()) outcome.found += ", ";
  outcome.found += fmt::format("{} x {}", count, what);
}

void find(FaultOutcome& outcome, const FaultRecording::Again& again) {
  find(outcome, again.different, "steps that differ in the replay");
  if (!again.problem.empty()) find(outcome, 1, again.problem.c_str());
}

void measure(FaultOutcome& outcome, double worst, double bound) {
  outcome.measured = true;
  outcome.worst = worst;
  outcome.bound = bound;
}

// Three translations and a turn, each a sine of 0.3 to 0.9 Hz: up to 18 mm and 0.15 rad.
FaultRun::FaultRun(const RowRun& row, const FaultOptions& options)
    : random_(row.seed ^ 0xfa17ULL),
      cell_(fault_cell(row.seed, options)),
      recording_(row.replay ? std::make_unique<FaultRecording>(*cell_, options) : nullptr),
      auditor_(audit_limits()),
      controller_(audit_limits().joints, audit_limits().period) {
  for (std::size_t k = 0; k < 4; ++k) {
    hand_[k] =
        options.contact ? 0.0 : (k < 3 ? 18.0 * kMm : 0.15) * (0.5 + 0.5 * random_.uniform());
    hand_[k + 4] = 2.0 * std::numbers::pi * (0.3 + 0.6 * random_.uniform());
    hand_[k + 8] = 2.0 * std::numbers::pi * random_.uniform();
  }
  if (options.brisk) {
    hand_[3] *= 2.0;
    hand_[7] *= 2.0;
  }
  for (std::size_t k = 0; options.gentle && k < 4; ++k) hand_[k] *= 0.1;
  layers_.heard = [this](const RobotReply& reply) { hear_controller(reply); };
  cell_->set_tap(&layers_);
}

double FaultRun::true_force() const {
  const World* world = cell_->rig().world();
  return world == nullptr ? 0.0 : world->on_tip().force.dot(fault_normal());
}

void FaultRun::set_network(const LinkFaults& faults) { to_slave() = to_master() = faults; }

HandReading FaultRun::hand_now() {
  const double t = to_seconds(now() + kMillisecond);
  HandReading hand;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    hand.X_MH.p[k] = hand_[i] * std::sin(hand_[i + 4] * t + hand_[i + 8]);
    hand.v_MH[k] = hand_[i] * hand_[i + 4] * std::cos(hand_[i + 4] * t + hand_[i + 8]);
  }
  hand.X_MH.q =
      Quat(Eigen::AngleAxisd(hand_[3] * std::sin(hand_[7] * t + hand_[11]), Vec3(0.6, 0.0, 0.8)));
  hand.valid = true;
  if (layers_.hand) layers_.hand(now(), hand);
  return hand;
}

void FaultRun::tick(const HapticOrder& order) {
  cell_->net()->link().to_slave().clear_deliveries();
  cell_->net()->link().to_master().clear_deliveries();
  const std::vector<JointVector> maybe_held = maybe_held_;
  const JointVector next = 2.0 * targets_[0] - targets_[1];
  cell_->tick(hand_now(), order);
  if (recording_) recording_->pull();
  feed_controller_audit();
  feed_auditor();
  judge_halt(maybe_held, next);
  follow_loop();
  watch_servo();
  if (cell_->rig().world() != nullptr) watch_surface();
  const bool should = auditor_.led();
  if (!should || may_hold_ || engaged()) led_since_ = now();
  if (now() - led_since_ > kResumePatience) ++not_resumed_;
}

void FaultRun::set_robot_line(const LinkFaults& commands, const LinkFaults& replies) {
  may_halt_ = true;
  cell_->robot_line()->to_robot.faults = commands;
  cell_->robot_line()->to_slave.faults = replies;
}

void FaultRun::feed_controller_audit() {
  for (const ControllerCycle& cycle : cell_->controller_cycles()) {
    if (cycle.took) {
      const Nanos since = sent_at_ < 0 ? 0 : cycle.at - sent_at_;
      controller_.accepted(cycle.at, cycle.q, static_cast<int>(since / kMxtPeriod));
      sent_at_ = -1;
    } else {
      controller_.until(cycle.at);
    }
  }
}

// What was sent before the target that the controller holds is over.
void FaultRun::hear_controller(const RobotReply& reply) {
  if (!reply.has_commanded) return;
  maybe_held_.erase(maybe_held_.begin(), nearest_held(reply.q_commanded));
}

// The target of which `q` is what 32 bits make of it.
JointVector FaultRun::as_sent(const JointVector& q) {
  return maybe_held_.empty() ? q : *nearest_held(q);
}

std::vector<JointVector>::iterator FaultRun::nearest_held(const JointVector& q) {
  auto held = maybe_held_.begin();
  for (auto it = held; it != maybe_held_.end(); ++it) {
    if ((*it - q).norm() <= (*held - q).norm()) held = it;
  }
  return held;
}

// The slave says when it halts the arm; whether it had to is judged here, by what the controller
// might have held before this tick and the target that was `next`.
void FaultRun::judge_halt(const std::vector<JointVector>& maybe_held, const JointVector& next) {
  const FollowState& slave = cell_->follow_state();
  const bool told = slave.halts != told_halts_;
  told_halts_ = slave.halts;
  // A motion that was over was not halted by the slave, which says that its end did not arrive.
  if (!told || !slave.halted || paused_) return;
  // Nor is it in vain when nothing was heard for as long as a plan may go on.
  if (maybe_held.size() >= ControllerAudit::kMostLost) return;
  const double dt = to_seconds(kMxtPeriod);
  // What the arm gained in the cycles that were not answered is not in `next`: at most four.
  const JointVector room =
      dt * rv2a_limits().max_speed - 4.0 * dt * dt * rv2a_limits().max_acceleration;
  const auto beyond = [&](const JointVector& held) {
    return ((next - held).array().abs() > room.array()).any();
  };
  if (std::none_of(maybe_held.begin(), maybe_held.end(), beyond)) ++halts_in_vain_;
}

// A slave that starts has where the arm is held from the controller, in 32 bits: that is no step.
JointVector FaultRun::as_before(const JointVector& q) const {
  const JointVector rounded =
      targets_[0].unaryExpr([](double v) -> double { return in_32_bits(v); });
  return q == rounded ? targets_[0] : q;
}

void FaultRun::sent_target(const JointVector& q, Nanos at) {
  if (sent_at_ < 0) sent_at_ = at;
  maybe_held_.push_back(q);
  targets_ = {q, targets_[0]};
}

void FaultRun::feed_auditor() {
  LinkWay& way = cell_->net()->link().to_slave();
  const auto deliveries = way.deliveries();
  std::size_t next = 0;
  const auto take = [&](Nanos until) {
    for (; next < deliveries.size() && deliveries[next].at <= until; ++next) {
      auditor_.delivered(deliveries[next]);
      if (auditor_.report().fresh == fresh_) continue;
      fresh_ = auditor_.report().fresh;
      if (last_fresh_ >= 0) {
        longest_gap_ = std::max(longest_gap_, deliveries[next].at - last_fresh_);
      }
      last_fresh_ = deliveries[next].at;
    }
  };
  if (!cell_->targets().empty()) {
    take(cell_->target_at());
    if (true_force() > 0.0) auditor_.touched(fault_normal());
    for (const JointVector& target : cell_->targets()) {
      const JointVector q = as_before(target);
      auditor_.commanded(q, cell_->target_at());
      sent_target(q, cell_->target_at());
    }
  }
  // An arm that was halted is commanded by nobody: what counts is where the controller holds it.
  if (cell_->targets().empty() && cell_->follow_state().gap) {
    for (const ControllerCycle& cycle : cell_->controller_cycles()) {
      take(cycle.at);
      auditor_.commanded(as_sent(cycle.q), cycle.at);
    }
  }
  take(now());
  auditor_.reported(cell_->slave().applied_sequence);
  auditor_.felt(cell_->master().f_H_M);
  // What was sent in this tick is delivered in the next at the earliest.
  for (; sent_ < way.counters().sent;) {
    master_sent_[(sent_ + 1) % kLoop] = now();
    auditor_.sent(++sent_, incarnation_, instead_ != nullptr ? *instead_ : cell_->master().link,
                  stalled_);
  }
  for (const Delivery& back : cell_->net()->link().to_master().deliveries()) {
    master_heard_ = back.at;
  }
}

// By the truth of the network alone.
void FaultRun::follow_loop() {
  VirtualLink& link = cell_->net()->link();
  for (const Delivery& there : link.to_slave().deliveries()) {
    if (there.authentic()) {
      slave_knows_ = std::max(slave_knows_, master_sent_[there.number % kLoop]);
    }
  }
  while (slave_sent_ < link.to_master().counters().sent) {
    slave_answers_[++slave_sent_ % kLoop] = slave_knows_;
  }
  for (const Delivery& back : link.to_master().deliveries()) {
    if (back.authentic()) answered_ = std::max(answered_, slave_answers_[back.number % kLoop]);
  }
}

double FaultRun::tracking_error() const {
  return errors_ == 0 ? 0.0 : std::sqrt(error_squared_ / static_cast<double>(errors_));
}

// Once a cycle of the controller.
void FaultRun::watch_servo() {
  constexpr double kStill = 1e-5;  // [rad] a cycle
  if (cell_->targets().empty()) return;
  error_squared_ += (auditor_.tip() - cell_->master().link.X_SU.p).squaredNorm();
  ++errors_;
  const JointVector& q = cell_->rig().controller().arm().joints();
  const bool still = (q - q_arm_).cwiseAbs().maxCoeff() < kStill;
  q_arm_ = q;
  if (auditor_.moving()) {
    stood_since_ = now();
  } else if (!still && stood_since_ >= 0) {
    settled_ = std::max(settled_, to_seconds(now() - stood_since_) * 1e3);
  }
}

bool FaultRun::engaged() const {
  const SessionState state = cell_->slave().state;
  return state == SessionState::kEngaged || state == SessionState::kClutched;
}

bool FaultRun::engage() {
  const Nanos patience = now() + kPatience;
  while (!(engaged() && cell_->master_state().lead.session == SessionState::kEngaged)) {
    if (now() > patience) return false;
    tick(order_of(OrderKind::kEngage));
  }
  run(kSecond);
  last_fresh_ = -1;
  longest_gap_ = 0;
  error_squared_ = 0.0;
  errors_ = 0;
  return true;
}

void FaultRun::run(Nanos span) {
  for (const Nanos end = now() + span; now() < end;) tick();
}

void FaultRun::drive(Nanos span) {
  for (const Nanos end = now() + span; now() < end;) {
    const SessionState session = cell_->master_state().lead.session;
    HapticOrder order;
    const bool idle = session == SessionState::kFault || session == SessionState::kOff;
    if (!idle) next_order_ = now() + kOperatorDelay;
    if (idle && now() >= next_order_) {
      const bool fault = session == SessionState::kFault ||
                         cell_->master().order_result == Reason::kPeerFault ||
                         cell_->net()->master().newest().state == SessionState::kFault;
      order = order_of(fault ? OrderKind::kReset : OrderKind::kEngage);
      if (fault) next_order_ = now() + kOperatorDelay;
    }
    tick(order);
  }
}

void FaultRun::stall_master(bool stalled) {
  stalled_ = stalled;
  cell_->stall_master(stalled);
}

void FaultRun::restart_master() {
  ++incarnation_;
  cell_->restart_master();
}

void FaultRun::send_instead(const MasterState* state) {
  instead_ = state;
  cell_->send_instead(state);
}

void FaultRun::watch_surface() {
  const double force = true_force();
  const double height = cell_->rig().controller().arm().true_tip().p.dot(fault_normal());
  if (engaged()) {
    force_led_ = force;
    height_led_ = height;
  } else if (force > 0.0) {
    harder_ = std::max(harder_, force - force_led_);
    deeper_ = std::max(deeper_, height_led_ - height);
  }
}

FaultOutcome FaultRun::outcome() {
  auditor_.finish();
  const AuditReport& report = auditor_.report();
  FaultOutcome out;
  if (report.stops > 0) {
    measure(out, to_seconds(report.worst.took) * 1e3, to_seconds(report.worst.allowed) * 1e3);
  }
  for (std::size_t i = 0; i < report.breaches.size(); ++i) {
    const auto breach = static_cast<Breach>(i);
    // A halt breaks these; whether it may is judged below.
    const bool of_halt =
        breach == Breach::kSpeed || breach == Breach::kAcceleration || breach == Breach::kJerk;
    if (!(may_halt_ && of_halt)) find(out, report.breaches[i], name_of(breach));
  }
  find(out, controller_.breaches(), "beyond the limits at the controller");
  find(out, may_halt_ ? halts_in_vain_ : controller_.halts(), "halts in vain");
  find(out, controller_.halts() > told_halts_, "halts that were not told");
  const Alarm& alarm = cell_->rig().controller().alarm();
  if (alarm.kind != AlarmKind::kNone) find(out, 1, describe(alarm.kind));
  find(out, report.worst.took > report.worst.allowed && report.of(Breach::kLateStop) == 0,
       name_of(Breach::kLateStop));
  out.settled = settled_;
  out.harder = harder_;
  out.deeper = deeper_ * 1e3;
  find(out, not_resumed_, "ms not engaged with a link that had come back");
  if (recording_) find(out, recording_->again());
  return out;
}

}  // namespace handrail
