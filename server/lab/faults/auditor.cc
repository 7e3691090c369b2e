#include "server/lab/faults/auditor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace handrail {
namespace {

constexpr double kRounding = 1e-9;       // of a limit
constexpr double kStandingStep = 1e-12;  // a smaller step is none [rad]
constexpr double kCatchUp = 0.06;        // a tip off its tool comes to it at least this fast [m/s]
constexpr double kToolGrace = 0.3;       // from when a tool comes to when that counts [s]

bool drives(const MasterState& state) {
  return state.desired != Desired::kOff &&
         (state.state == SessionState::kEngaged || state.state == SessionState::kClutched ||
          state.state == SessionState::kHold);
}

}  // namespace

const char* name_of(Breach breach) noexcept {
  switch (breach) {
    case Breach::kNotFinite:
      return "not finite";
    case Breach::kRange:
      return "joint range";
    case Breach::kSpeed:
      return "joint speed";
    case Breach::kAcceleration:
      return "joint acceleration";
    case Breach::kJerk:
      return "joint jerk";
    case Breach::kUnled:
      return "moved without being led";
    case Breach::kLateStop:
      return "stopped late";
    case Breach::kUnasked:
      return "went where nobody asked";
    case Breach::kOffTool:
      return "off the tool";
    case Breach::kCount:
      break;
  }
  return "unknown";
}

std::uint64_t AuditReport::total() const noexcept {
  return std::accumulate(breaches.begin(), breaches.end(), std::uint64_t{0});
}

Auditor::Auditor(const AuditLimits& limits)
    : limits_(limits), dt_(to_seconds(limits.period)), sent_(kRemembered) {}

void Auditor::sent(std::uint64_t number, std::uint32_t incarnation, const MasterState& state,
                   bool repeated) noexcept {
  Sent& entry = sent_[number % kRemembered];
  entry.number = number;
  entry.incarnation = incarnation;
  entry.drives = drives(state);
  entry.stops = state.stop_epoch != state.released_epoch;
  entry.aligning = state.desired != Desired::kOff && state.state == SessionState::kAligning;
  entry.has_command = state.has_command;
  entry.repeated = repeated;
  entry.p_SU = state.X_SU.p;
  entry.tool = state.position_tool;
}

// Newest wins; another incarnation counts only once the present one has been silent for long.
void Auditor::delivered(const Delivery& delivery) noexcept {
  const Sent& entry = sent_[delivery.number % kRemembered];
  if (!delivery.authentic || entry.number != delivery.number) return;
  if (heard_ && entry.number <= newest_.number) return;
  if (heard_ && entry.incarnation != newest_.incarnation) {
    if (delivery.at - heard_at_ <= kLatch) return;
    latched_ = true;
  }
  ++report_.fresh;
  const bool drove = heard_ && newest_.drives && !newest_.stops;
  if (drove && !(entry.drives && !entry.stops)) told_at_ = delivery.at;
  newest_ = entry;
  heard_ = true;
  if (!entry.repeated) heard_at_ = delivery.at;
  if (entry.aligning) latched_ = must_stop_ = false;
  if (entry.has_command) remember_place(entry.p_SU, delivery.at);
  if (entry.tool.epoch != tool_.definition().epoch) {
    tool_ = PositionTool(entry.tool, GuidanceMethod::kExact, 1e-4);
    tool_led_ = 0.0;
    tool_radius_ = -1.0;  // the next cycle's distance
  }
}

void Auditor::must_stop(Nanos at) noexcept {
  if (must_stop_) return;
  must_stop_ = true;
  must_stop_at_ = at;
}

void Auditor::commanded(const JointVector& q, Nanos at) noexcept {
  ++report_.cycles;
  if (!q.allFinite()) {
    breach(Breach::kNotFinite);
    return;
  }
  const bool was_moving = moving_;
  if (!placed_) {
    placed_ = true;
    q_ = q;
  }
  // The stop is judged by how fast the arm was before this command.
  check_led(at);
  if (!led_ && !stopping_) begin_stop(at);
  if (led_ && stopping_) end_stop();
  stop_needs_operator_ = stop_needs_operator_ || latched_ || must_stop_ || newest_.stops;
  check_limits(q);
  tip_ = forward(limits_.arm, q).p;
  if (!moving_) rest_ = tip_;
  if (moving_) {
    ++report_.moved;
    if (!led_) {
      const bool stood = !was_moving;
      if (stood) {
        breach(Breach::kUnled);
      } else if (at - stop_from_ > stop_allowed_) {
        breach(Breach::kLateStop);
      }
      last_moved_ = at;
    }
    check_place(at);
  }
  check_tool();
}

void Auditor::check_limits(const JointVector& q) noexcept {
  const JointVector step = q - q_;
  const JointVector change = step - step_;
  const JointVector jolt = change - change_;
  q_ = q;
  step_ = step;
  change_ = change;
  moving_ = step.cwiseAbs().maxCoeff() > kStandingStep;
  const JointLimits& joints = limits_.joints;
  const double v = (step.array().abs() / (joints.max_speed.array() * dt_)).maxCoeff();
  const double a =
      (change.array().abs() / (joints.max_acceleration.array() * dt_ * dt_)).maxCoeff();
  const double j = (jolt.array().abs() / (limits_.max_jerk.array() * dt_ * dt_ * dt_)).maxCoeff();
  report_.speed = std::max(report_.speed, v);
  report_.acceleration = std::max(report_.acceleration, a);
  report_.jerk = std::max(report_.jerk, j);
  if (v > 1.0 + kRounding) breach(Breach::kSpeed);
  if (a > 1.0 + kRounding) breach(Breach::kAcceleration);
  if (j > 1.0 + kRounding) breach(Breach::kJerk);
  const bool below = ((q - joints.lower).array() < -kRounding).any();
  if (below || ((joints.upper - q).array() < -kRounding).any()) breach(Breach::kRange);
}

void Auditor::check_led(Nanos at) noexcept {
  const Nanos age = heard_ ? at - heard_at_ : kForever;
  if (heard_ && !latched_ && age > kLatch) {
    latched_ = true;
    ++report_.latched;
  }
  led_ = heard_ && !latched_ && !must_stop_ && age <= kWatchdog && newest_.drives && !newest_.stops;
}

void Auditor::begin_stop(Nanos at) noexcept {
  stopping_ = true;
  stop_while_moving_ = moving_;
  stop_needs_operator_ = false;
  const Nanos age = heard_ ? at - heard_at_ : 0;
  stop_from_ = at;
  stop_allowed_ = limits_.period + kOverhead;
  if (must_stop_) {
    stop_from_ = must_stop_at_;
  } else if (heard_ && age > kWatchdog) {
    stop_from_ = heard_at_;
    stop_allowed_ += kWatchdog;
  } else if (heard_) {
    stop_from_ = told_at_;
  }
  double longest = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const double a = limits_.joints.max_acceleration[i];
    longest = std::max(longest, std::abs(step_[i]) / dt_ / a + 2.5 * a / limits_.max_jerk[i]);
  }
  stop_allowed_ += from_seconds(longest);
  last_moved_ = stop_from_;
}

// Whatever stopped the arm is over: the operator engaged again, or the link is back.
void Auditor::end_stop() noexcept {
  stopping_ = false;
  if (!stop_while_moving_) return;
  if (!stop_needs_operator_) ++report_.resumed;
  record_stop();
}

void Auditor::finish() noexcept {
  if (stopping_ && stop_while_moving_) record_stop();
  stopping_ = false;
}

void Auditor::record_stop() noexcept {
  ++report_.stops;
  const AuditedStop stop{last_moved_ - stop_from_, stop_allowed_};
  if (report_.stops == 1 || stop.took - stop.allowed > report_.worst.took - report_.worst.allowed) {
    report_.worst = stop;
  }
}

void Auditor::remember_place(const Vec3& p, Nanos at) noexcept {
  const auto index = static_cast<std::size_t>((at / kBucket) % static_cast<Nanos>(kBuckets));
  Box& box = boxes_[index];
  const Nanos from = at / kBucket * kBucket;
  if (box.from != from) {
    box = {from, p, p};
    return;
  }
  box.low = box.low.cwiseMin(p);
  box.high = box.high.cwiseMax(p);
}

// A tip that only ever moves toward fresh commands stays among them and where it stood.
void Auditor::check_place(Nanos at) noexcept {
  if (!heard_) return;
  Vec3 low = rest_.cwiseMin(newest_.p_SU);
  Vec3 high = rest_.cwiseMax(newest_.p_SU);
  for (const Box& box : boxes_) {
    if (at - box.from > static_cast<Nanos>(kBuckets) * kBucket) continue;
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  const bool outside =
      ((tip_ - low).array() < -kRoom).any() || ((high - tip_).array() < -kRoom).any();
  if (outside) breach(Breach::kUnasked);
}

// Once on a tool the tip stays there; until then it comes nearer, and at least so fast while led.
void Auditor::check_tool() noexcept {
  if (!tool_.active()) return;
  const double distance = tool_.distance(tip_);
  if (tool_radius_ < 0.0) tool_radius_ = distance;
  if (led_) tool_led_ += dt_;
  if (tool_led_ <= kToolGrace) {
    tool_radius_ = std::max(tool_radius_, distance);
    return;
  }
  if (led_) tool_radius_ = std::max(0.0, tool_radius_ - kCatchUp * dt_);
  if (distance > tool_radius_ + kOffTool) breach(Breach::kOffTool);
  tool_radius_ = std::min(tool_radius_, distance);
}

}  // namespace handrail
