#include "server/lab/faults/audit/heard_master.h"

namespace handrail {
namespace {

// A master in hold leads nobody: it hears nothing of the arm.
bool drives(const MasterState& state) {
  return state.desired != Desired::kOff &&
         (state.state == SessionState::kEngaged || state.state == SessionState::kClutched);
}

}  // namespace

void HeardMaster::sent(std::uint64_t number, std::uint32_t incarnation, const MasterState& state,
                       bool repeated) noexcept {
  SentState& entry = sent_[number % kRemembered];
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
bool HeardMaster::delivered(const Delivery& delivery, AuditReport& report) noexcept {
  const SentState& entry = sent_[delivery.number % kRemembered];
  if (!delivery.authentic() || entry.number != delivery.number) return false;
  if (any_ && entry.number <= newest_.number) return false;
  if (any_ && entry.incarnation != newest_.incarnation) {
    if (delivery.at - heard_at_ <= kLatch) return false;
    latched_ = true;
  }
  ++report.fresh;
  if (any_ && newest_.leads() && !entry.leads()) told_at_ = delivery.at;
  newest_ = entry;
  any_ = true;
  if (!entry.repeated) heard_at_ = delivery.at;
  if (entry.aligning) latched_ = must_stop_ = false;
  return true;
}

void HeardMaster::must_stop(Nanos at) noexcept {
  if (must_stop_) return;
  must_stop_ = true;
  must_stop_at_ = at;
}

void HeardMaster::judge(Nanos at, AuditReport& report) noexcept {
  const Nanos age = any_ ? at - heard_at_ : kForever;
  if (any_ && !latched_ && age > kLatch) {
    latched_ = true;
    ++report.latched;
  }
  led_ = any_ && !latched_ && !stop_is_due(at) && age <= kWatchdog && newest_.leads();
}

HeardMaster::Cause HeardMaster::cause_of_stop(Nanos at) const noexcept {
  if (stop_is_due(at)) return {must_stop_at_, 0};
  if (!any_) return {at, 0};
  if (at - heard_at_ > kWatchdog) return {heard_at_, kWatchdog};
  return {told_at_, 0};
}

}  // namespace handrail
