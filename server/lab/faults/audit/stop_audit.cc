#include "server/lab/faults/audit/stop_audit.h"

namespace handrail {

void StopAudit::judge(const HeardMaster& master, Nanos at, bool at_rest, double stop_time,
                      AuditReport& report) noexcept {
  if (!master.led() && !stopping_) begin(master, at, at_rest, stop_time);
  if (master.led()) led(report);
  needs_operator_ = needs_operator_ || master.needs_operator(at);
}

void StopAudit::led(AuditReport& report) noexcept {
  if (stopping_) end(report);
}

void StopAudit::begin(const HeardMaster& master, Nanos at, bool at_rest,
                      double stop_time) noexcept {
  stopping_ = true;
  while_moving_ = !at_rest;
  needs_operator_ = false;
  const HeardMaster::Cause cause = master.cause_of_stop(at);
  from_ = cause.from;
  allowed_ = period_ + kOverhead + cause.due + from_seconds(stop_time);
  last_moved_ = from_;
}

void StopAudit::moved_unled(Nanos at, bool was_at_rest, AuditReport& report) noexcept {
  if (was_at_rest) {
    report.add(Breach::kUnled);
  } else if (at - from_ > allowed_) {
    report.add(Breach::kLateStop);
  }
  last_moved_ = at;
}

// Whatever stopped the arm is over: the operator engaged again, or the link is back.
void StopAudit::end(AuditReport& report) noexcept {
  stopping_ = false;
  if (!while_moving_) return;
  if (!needs_operator_) ++report.resumed;
  record(report);
}

void StopAudit::finish(AuditReport& report) noexcept {
  if (stopping_ && while_moving_) record(report);
  stopping_ = false;
}

void StopAudit::record(AuditReport& report) const noexcept {
  ++report.stops;
  const AuditedStop stop{last_moved_ - from_, allowed_};
  if (report.stops == 1 || stop.took - stop.allowed > report.worst.took - report.worst.allowed) {
    report.worst = stop;
  }
}

}  // namespace handrail
