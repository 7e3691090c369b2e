// What the judge of a fault run found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>

#include "server/base/time.h"
#include "server/lab/faults/audit/joint_audit.h"

namespace handrail {

// One stop, from what forced it to the last command that moved.
struct AuditedStop {
  Nanos took = 0;
  Nanos allowed = 0;
};

struct AuditReport {
  BreachCounts breaches{};
  std::uint64_t cycles = 0;
  std::uint64_t moved = 0;    // cycles that moved a joint
  std::uint64_t fresh = 0;    // datagrams that were the newest of the authentic master's session
  std::uint64_t stops = 0;    // forced while moving
  std::uint64_t resumed = 0;  // of them, went on by themselves
  std::uint64_t latched = 0;  // links lost for so long that an operator has to engage again
  AuditedStop worst;          // the stop with the least time left of what it was allowed
  // Largest of any joint and cycle, 1 = the limit.
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;

  std::uint64_t total() const noexcept {
    return std::accumulate(breaches.begin(), breaches.end(), std::uint64_t{0});
  }
  std::uint64_t of(Breach breach) const noexcept {
    return breaches[static_cast<std::size_t>(breach)];
  }
  void add(Breach breach) noexcept { ++breaches[static_cast<std::size_t>(breach)]; }
};

}  // namespace handrail
