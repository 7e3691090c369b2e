// The judge of how far the tip is off its tool.
#pragma once

#include <algorithm>
#include <cstdint>

#include "server/lab/faults/audit/heard_master.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/faults/audit/tip_way.h"
#include "server/model/tip_space.h"

namespace handrail {

// A tip beside its tool only ever comes nearer, but for its own stop: what it was when the tool
// came, and at each command since that was no further off itself. Its way there closes behind it no
// faster than it is eased along it, and not while nobody leads it. Once on it, it stays. Real-time
// safe.
class ToolAudit {
 public:
  static constexpr double kOffTool = 1e-5;  // [m]

  // `eased`: the way onto a tool in a cycle, at most [m].
  explicit ToolAudit(double eased) noexcept : eased_(eased) {}

  // What the slave must take of a fresh datagram.
  void take(const SentState& entry) noexcept;
  // Before each command.
  void expect(const HeardMaster& master, const JointAudit& joints, const TipWay& motion) noexcept;
  // A surface holds the tip out there.
  void hold_out(const Vec3& p) noexcept { reach_ = std::max(reach_, space_.distance(p)); }
  bool off(const Vec3& tip) const noexcept {
    return !space_.everything() && space_.distance(tip) > reach_ + kOffTool;
  }

 private:
  double eased_;
  ToolDefinition tool_;
  std::uint32_t of_ = 0;  // incarnation
  TipSpace space_;
  bool new_ = false;    // since the last command
  double reach_ = 0.0;  // the tip goes no further from the tool [m]
};

}  // namespace handrail
