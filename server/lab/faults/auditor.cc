#include "server/lab/faults/auditor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace handrail {
namespace {

constexpr double kRounding = 1e-9;  // of a limit

// A master in hold leads nobody: it hears nothing of the arm.
bool drives(const MasterState& state) {
  return state.desired != Desired::kOff &&
         (state.state == SessionState::kEngaged || state.state == SessionState::kClutched);
}

}  // namespace

std::uint64_t AuditReport::total() const noexcept {
  return std::accumulate(breaches.begin(), breaches.end(), std::uint64_t{0});
}

Auditor::Auditor(const AuditLimits& limits)
    : limits_(limits),
      dt_(to_seconds(limits.period)),
      sent_(kRemembered),
      joints_(limits),
      last_asked_(limits) {}

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
  entry.X_SU = state.X_SU;
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
  if (entry.has_command) remember_place(entry.X_SU.p, delivery.at);
  take_tool(entry);
}

void Auditor::must_stop(Nanos at) noexcept {
  if (must_stop_) return;
  must_stop_ = true;
  must_stop_at_ = at;
}

void Auditor::felt(const Wrench& f) noexcept {
  if (!is_finite(f) || f.force.norm() > limits_.force * (1.0 + kRounding)) breach(Breach::kForce);
}

void Auditor::reported(std::uint64_t applied) noexcept {
  if (applied == applied_) return;
  if (applied < applied_ && applied != 0 && newest_.incarnation == applied_of_) {
    breach(Breach::kBackward);
  }
  applied_ = applied;
  applied_of_ = newest_.incarnation;
}

void Auditor::touched(const Vec3& n_S) noexcept {
  touched_ = true;
  n_S_ = n_S;
}

void Auditor::commanded(const JointVector& q, Nanos at) noexcept {
  ++report_.cycles;
  const bool was_at_rest = joints_.at_rest();
  // The stop is judged by how fast the arm was before this command.
  stop_time_ = joints_.time_to_stop();
  check_led(at);
  if (!led_ && !stopping_) begin_stop(at);
  if (led_ && stopping_) end_stop();
  stop_needs_operator_ = stop_needs_operator_ || latched_ || stop_is_due(at) || newest_.stops;
  reach_of_tool();
  if (!joints_.commanded(q, report_.breaches)) return;
  report_.speed = joints_.speed();
  report_.acceleration = joints_.acceleration();
  report_.jerk = joints_.jerk();
  if (report_.cycles == 1) tips_.fill(tip());
  if (touched_) hold_out(at);
  check_tool();
  tips_ = {tip(), tips_[0], tips_[1]};
  if (!joints_.moving()) {
    rest_ = tip();
    return;
  }
  ++report_.moved;
  if (!led_) {
    if (was_at_rest) {
      breach(Breach::kUnled);
    } else if (at - stop_from_ > stop_allowed_) {
      breach(Breach::kLateStop);
    }
    last_moved_ = at;
  }
  check_place(at);
}

void Auditor::check_led(Nanos at) noexcept {
  const Nanos age = heard_ ? at - heard_at_ : kForever;
  if (heard_ && !latched_ && age > kLatch) {
    latched_ = true;
    ++report_.latched;
  }
  led_ = heard_ && !latched_ && !stop_is_due(at) && age <= kWatchdog && newest_.drives &&
         !newest_.stops;
}

void Auditor::begin_stop(Nanos at) noexcept {
  stopping_ = true;
  stop_while_moving_ = !joints_.at_rest();
  stop_needs_operator_ = false;
  const Nanos age = heard_ ? at - heard_at_ : 0;
  stop_from_ = at;
  stop_allowed_ = limits_.period + kOverhead;
  if (stop_is_due(at)) {
    stop_from_ = must_stop_at_;
  } else if (heard_ && age > kWatchdog) {
    stop_from_ = heard_at_;
    stop_allowed_ += kWatchdog;
  } else if (heard_) {
    stop_from_ = told_at_;
  }
  stop_allowed_ += from_seconds(stop_time_);
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

// A tip that only ever moves toward fresh commands comes nearer to the newest, but as far as that
// goes itself; or it stays among them and where it stood, where the arm can reach them. But for its
// stop where they turn before it.
void Auditor::check_place(Nanos at) noexcept {
  if (!heard_) return;
  const Pose& asked = newest_.X_SU;
  const double gap = (tip() - asked.p).norm();
  const bool was_beyond = beyond_reach_;
  beyond_reach_ = newest_.has_command && !in_reach(asked);
  double went = (asked.p - asked_.p).norm();
  // Out of reach the place that the tip gets to goes along with the turn asked for.
  if (beyond_reach_) went += limits_.arm.d6 * angle_between(asked.q, asked_.q);
  asked_ = asked;
  gap_ = beyond_reach_ && !was_beyond ? gap : std::min(gap_ + went, gap);
  if (beyond_reach_) {
    // What now is asked may lie behind a tip on its way.
    if (!was_beyond || went > 0.0) remember_stop();
    if (too_far(gap - gap_)) breach(Breach::kUnasked);
    remember_place(tip(), at);
    return;
  }
  Vec3 low = rest_.cwiseMin(asked.p);
  Vec3 high = rest_.cwiseMax(asked.p);
  for (const Box& box : boxes_) {
    if (at - box.from > static_cast<Nanos>(kBuckets) * kBucket) continue;
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  const double outside = std::max((low - tip()).maxCoeff(), (tip() - high).maxCoeff());
  const double off = std::min(outside, gap - gap_);
  if (off <= 0.0) remember_stop();
  if (too_far(off)) breach(Breach::kUnasked);
}

// The place commanded, out of the surface as far as the tip is, is one where it may be.
void Auditor::hold_out(Nanos at) noexcept {
  touched_ = false;
  if (!heard_ || !newest_.has_command) return;
  const Vec3 p = newest_.X_SU.p + std::max(0.0, (tip() - newest_.X_SU.p).dot(n_S_)) * n_S_;
  remember_place(p, at);
  tool_reach_ = std::max(tool_reach_, space_.distance(p));
}

void Auditor::remember_stop() noexcept {
  last_asked_ = joints_;
  even_way_ = even_way();
}

// Further off than any stop since the tip was last where it was asked to be.
bool Auditor::too_far(double off) const noexcept {
  return off > kRoom + even_way_ && off > kRoom + last_asked_.way_of_joints();
}

bool Auditor::in_reach(const Pose& X) const noexcept {
  JointVector q;
  return is_finite(X) && inverse_near(limits_.arm, X, joints_.q(), q) == InverseStatus::kOk &&
         (q.array() >= limits_.joints.lower.array()).all() &&
         (q.array() <= limits_.joints.upper.array()).all();
}

// What the slave must take: a newer definition, or whatever the master comes back with. Another
// definition of the same epoch is none.
void Auditor::take_tool(const Sent& entry) noexcept {
  const bool newer = entry.tool.epoch > tool_.epoch;
  if (!newer && !entry.aligning && entry.incarnation == tool_of_) return;
  tool_of_ = entry.incarnation;
  if (entry.tool.epoch == tool_.epoch && hash_of(entry.tool) == hash_of(tool_)) return;
  tool_ = entry.tool;
  space_ = space_of(tool_);
  tool_new_ = true;
}

// How far the tip goes [m] that loses speed v and acceleration a together, evenly, in the time T
// that the joints may need: the cubic through both ends, v T / 2 + a T^2 / 12. The bend of its path
// may turn all of it outward.
double Auditor::even_way() const noexcept {
  const Vec3 step = tips_[0] - tips_[1], last = tips_[1] - tips_[2];
  const double cycles = stop_time_ / dt_;
  return cycles / 2.0 * step.norm() + cycles * cycles / 12.0 * (step - last).norm();
}

double Auditor::way_to_rest() const noexcept {
  return std::max(even_way(), joints_.way_of_joints());
}

// A tip beside its tool only ever comes nearer, but for its own stop: what it was when the tool
// came, and at each command since that was no further off itself. Its way there closes behind it no
// faster than it is eased along it, and not while nobody leads it. Once on it, it stays.
void Auditor::reach_of_tool() noexcept {
  if (space_.everything()) return;
  const double reach = space_.distance(tips_[0]) + way_to_rest();
  const double asked = newest_.has_command ? space_.distance(newest_.X_SU.p) : 0.0;
  const double eased = tool_reach_ - (led_ ? limits_.catch_up * dt_ : 0.0);
  tool_reach_ = tool_new_ ? reach : std::min(tool_reach_, std::max({reach, asked, eased}));
  tool_new_ = false;
}

void Auditor::check_tool() noexcept {
  if (space_.everything()) return;
  if (space_.distance(tip()) > tool_reach_ + kOffTool) breach(Breach::kOffTool);
}

}  // namespace handrail
