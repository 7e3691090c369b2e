// The judge of stops: whether the arm rests in time.
#pragma once

#include "server/lab/faults/audit/audit_report.h"
#include "server/lab/faults/audit/heard_master.h"

namespace handrail {

// Real-time safe.
class StopAudit {
 public:
  // Of the stop bound beside the joints' own time: one cycle and 2 ms.
  static constexpr Nanos kOverhead = 2 * kMillisecond;

  explicit StopAudit(Nanos period) noexcept : period_(period) {}

  // Before each command, the master judged. `stop_time`: that the joints need [s].
  void judge(const HeardMaster& master, Nanos at, bool at_rest, double stop_time,
             AuditReport& report) noexcept;
  // Somebody led since the last command: what stops now is a stop of its own.
  void led(AuditReport& report) noexcept;
  // The command moves the arm, and nobody leads it. `was_at_rest`: before it.
  void moved_unled(Nanos at, bool was_at_rest, AuditReport& report) noexcept;
  // Counts a stop that still lasts.
  void finish(AuditReport& report) noexcept;

 private:
  void begin(const HeardMaster& master, Nanos at, bool at_rest, double stop_time) noexcept;
  void end(AuditReport& report) noexcept;
  void record(AuditReport& report) const noexcept;

  Nanos period_;
  bool stopping_ = false;
  bool while_moving_ = false;
  bool needs_operator_ = false;
  Nanos from_ = 0;
  Nanos last_moved_ = 0;
  Nanos allowed_ = 0;
};

}  // namespace handrail
