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
// faster than it is eased along it, and not while nobody leads it. Once on it, it stays.
//
// What a stop may still do when a tool comes is judged by when it is due: in each cycle the tip has
// less time left to go on in, and once the time is over it is never again further off than it has
// been. Real-time safe.
class ToolAudit {
 public:
  static constexpr double kOffTool = 1e-5;  // [m]

  // `eased`: the way onto a tool in a cycle, at most [m].
  ToolAudit(double eased, Nanos period) noexcept : eased_(eased), period_(period) {}

  // What the slave must take of a fresh datagram.
  void take(const SentState& entry) noexcept;
  // Before each command, that of `at`.
  void expect(const HeardMaster& master, const JointAudit& joints, const TipWay& motion,
              Nanos at) noexcept;
  // A surface holds the tip out there.
  void hold_out(const Vec3& p) noexcept {
    reach_ = std::max(reach_, space_.distance(p));
    been_ = std::max(been_, space_.distance(p));
  }
  // How often another definition was taken.
  std::uint64_t calls() const noexcept { return calls_; }
  // The place on the tool nearest to `p`.
  Vec3 on(const Vec3& p) const noexcept { return p - space_.off(p); }
  // Where a tip that is asked to `p` may go to that is held by the tool: between on(p) and `p`, as
  // far off the tool as it might be when that came. The nearest such place to `tip`.
  Vec3 brought(const Vec3& p, const Vec3& tip) const noexcept;
  bool off(const Vec3& tip) const noexcept {
    return !space_.everything() && space_.distance(tip) > reach_ + kOffTool;
  }

 private:
  double eased_;
  Nanos period_;
  ToolDefinition tool_;
  std::uint32_t of_ = 0;  // incarnation
  TipSpace space_;
  std::uint64_t calls_ = 0;
  bool new_ = false;    // since the last command
  double reach_ = 0.0;  // the tip goes no further from the tool [m]
  double came_ = 0.0;   // that, when the tool came [m]
  double been_ = 0.0;   // the furthest off since it came [m]
  Nanos due_ = 0;       // when the stop is over that it may have come into
};

}  // namespace handrail
