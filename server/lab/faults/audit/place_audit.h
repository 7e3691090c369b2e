// The judge of where the tip goes: nowhere that nobody sent it.
#pragma once

#include <array>
#include <cstddef>

#include "server/base/time.h"
#include "server/lab/faults/audit/heard_master.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/faults/audit/tip_way.h"

namespace handrail {

// Real-time safe.
class PlaceAudit {
 public:
  // A tip further from all recent commands than this, and than its own stop takes it where they
  // turn before it, goes where nobody sent it [m].
  static constexpr double kRoom = 0.005;

  explicit PlaceAudit(const AuditLimits& limits) noexcept : limits_(limits), last_asked_(limits) {}

  // The tip may be there.
  void remember(const Vec3& p, Nanos at) noexcept;
  void rests(const Vec3& tip) noexcept { rest_ = tip; }
  // A command moved the arm. False: where nobody sent it.
  bool commanded(const SentState& newest, const JointAudit& joints, const TipWay& motion,
                 Nanos at) noexcept;

 private:
  static constexpr std::size_t kBuckets = 21;  // of the recent commands' places
  static constexpr Nanos kBucket = 100 * kMillisecond;

  struct Box {
    Nanos from = -kForever;
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
  };

  bool in_reach(const Pose& X, const JointVector& from) const noexcept;
  double went_to(const Pose& asked) noexcept;
  double outside(const Vec3& tip, const Vec3& asked, Nanos at) const noexcept;
  void remember_stop(const JointAudit& joints, const TipWay& motion) noexcept;
  bool too_far(double off) const noexcept;

  AuditLimits limits_;
  std::array<Box, kBuckets> boxes_{};
  Vec3 rest_ = Vec3::Zero();   // where the tip last stood
  JointAudit last_asked_;      // when the tip was last where it was asked to be
  double even_way_ = 0.0;      // then [m]
  bool beyond_reach_ = false;  // as of the last command
  Pose asked_;                 // then
  double gap_ = 1e9;           // from it to the tip, at most [m]
};

}  // namespace handrail
