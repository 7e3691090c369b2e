// What the authentic master said and the slave heard, and whether that lets the arm move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/base/time.h"
#include "server/lab/faults/audit/audit_report.h"
#include "server/lab/network/link_way.h"
#include "server/model/link_state.h"

namespace handrail {

// One datagram of the master's.
struct SentState {
  std::uint64_t number = 0;
  std::uint32_t incarnation = 0;
  bool drives = false;    // engaged or clutched, and wanted
  bool stops = false;     // a stop stands
  bool aligning = false;  // asks to engage
  bool has_command = false;
  bool repeated = false;
  Pose X_SU;
  ToolDefinition tool;

  bool leads() const noexcept { return drives && !stops; }
};

// Real-time safe but for construction.
class HeardMaster {
 public:
  // How long after the last fresh datagram a stop is due, and when it needs an operator.
  static constexpr Nanos kWatchdog = 20 * kMillisecond;
  static constexpr Nanos kLatch = 200 * kMillisecond;

  HeardMaster() : sent_(kRemembered) {}

  void sent(std::uint64_t number, std::uint32_t incarnation, const MasterState& state,
            bool repeated) noexcept;
  // True when that is the newest of the master's session, and says something new.
  bool delivered(const Delivery& delivery, AuditReport& report) noexcept;
  void must_stop(Nanos at) noexcept;
  // Once a cycle: whether the arm may move.
  void judge(Nanos at, AuditReport& report) noexcept;

  bool any() const noexcept { return any_; }
  const SentState& newest() const noexcept { return newest_; }
  bool led() const noexcept { return led_; }  // as last judged
  bool stop_is_due(Nanos at) const noexcept { return must_stop_ && at >= must_stop_at_; }
  bool needs_operator(Nanos at) const noexcept {
    return latched_ || stop_is_due(at) || newest_.stops;
  }
  // From when on a stop that begins at `at` counts, and how long after it the stop is due.
  struct Cause {
    Nanos from = 0, due = 0;
  };
  Cause cause_of_stop(Nanos at) const noexcept;

 private:
  static constexpr std::size_t kRemembered = 8192;  // of what is replayed, 4096 back at most

  std::vector<SentState> sent_;
  SentState newest_;
  bool any_ = false;
  Nanos heard_at_ = -kForever;
  Nanos told_at_ = 0;       // when a fresh one first said no longer to move
  bool must_stop_ = false;  // from must_stop_at_ on
  Nanos must_stop_at_ = 0;
  bool latched_ = false;
  bool led_ = false;
};

}  // namespace handrail
