// The judge of where the tip goes: nowhere that nobody sent it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "server/base/time.h"
#include "server/lab/faults/audit/heard_master.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/faults/audit/tip_way.h"
#include "server/lab/faults/audit/tool_audit.h"

namespace handrail {

// Real-time safe.
class PlaceAudit {
 public:
  // A tip further from all recent commands than this, and than its own stop takes it where they
  // turn before it, goes where nobody sent it [m].
  static constexpr double kRoom = 0.005;

  explicit PlaceAudit(const AuditLimits& limits) noexcept : limits_(limits) {}

  // The tip may be there.
  void remember(const Vec3& p, Nanos at) noexcept;
  void rests(const Vec3& tip) noexcept { rest_ = tip; }
  // A command moved the arm. False: where nobody sent it.
  bool commanded(const SentState& newest, const ToolAudit& tool, const JointAudit& joints,
                 const TipWay& motion, Nanos at) noexcept;

 private:
  static constexpr std::size_t kBuckets = 21;  // of the recent commands' places
  static constexpr Nanos kBucket = 100 * kMillisecond;

  // The least that the tip was from a place asked for, as far as that went on since [m].
  struct Gap {
    double least = 1e9;
    double now = 0.0;
    void take(double gap, double went, bool anew) noexcept {
      least = anew ? gap : std::min(least + went, gap);
      now = gap;
    }
    double grown() const noexcept { return now - least; }
  };
  struct Box {
    Nanos from = -kForever;
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
  };

  bool in_reach(const Pose& X, const JointVector& from) const noexcept;
  double went_to(const Pose& asked) noexcept;
  double outside(const Vec3& tip, const Vec3& asked, Nanos at) const noexcept;

  AuditLimits limits_;
  std::array<Box, kBuckets> boxes_{};
  Vec3 rest_ = Vec3::Zero();   // where the tip last stood
  double stop_ = 0.0;          // of the tip, when it was last where it was asked to be [m]
  bool beyond_reach_ = false;  // as of the last command
  Pose asked_;                 // then
  std::uint64_t tool_ = 0;     // which of the tool's calls, then
  Gap gap_;                    // to what is asked
  Gap on_tool_;                // to that, brought onto the tool
};

}  // namespace handrail
