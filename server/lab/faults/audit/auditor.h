// The judge of a fault run. It sees the joint commands, the force on the hand and the network's
// truth, nothing of what master or slave think.
#pragma once

#include <cstdint>

#include "server/lab/faults/audit/audit_report.h"
#include "server/lab/faults/audit/heard_master.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/faults/audit/place_audit.h"
#include "server/lab/faults/audit/stop_audit.h"
#include "server/lab/faults/audit/tip_way.h"
#include "server/lab/faults/audit/tool_audit.h"
#include "server/lab/network/link_way.h"
#include "server/model/link_state.h"

namespace handrail {

// Call everything in the order of time. Between two events what the master sent and what was
// delivered comes first, then the command of the cycle. Real-time safe but for construction.
class Auditor {
 public:
  static constexpr Nanos kWatchdog = HeardMaster::kWatchdog;
  static constexpr Nanos kLatch = HeardMaster::kLatch;
  static constexpr Nanos kOverhead = StopAudit::kOverhead;
  static constexpr double kRoom = PlaceAudit::kRoom;
  static constexpr double kOffTool = ToolAudit::kOffTool;

  explicit Auditor(const AuditLimits& limits);

  // The authentic master, started for the `incarnation`-th time, sends its `number`-th datagram.
  // Numbers rise by one, also over restarts. `repeated`: its haptic loop has made no state since
  // the last datagram, so this one proves nobody alive.
  void sent(std::uint64_t number, std::uint32_t incarnation, const MasterState& state,
            bool repeated = false) noexcept;
  // The slave takes a datagram.
  void delivered(const Delivery& delivery) noexcept;
  // From `at` on, which may be yet to come, the arm must stop, whatever is sent, until an operator
  // engages again. The first call counts.
  void must_stop(Nanos at) noexcept { master_.must_stop(at); }
  // A surface pushes on the arm along `n_S`, out of it, unit: over what is commanded the next
  // command may hold the tip out that way, and no other.
  void touched(const Vec3& n_S) noexcept;
  // The slave commands `q`, once a cycle. The arm stands on the first one.
  void commanded(const JointVector& q, Nanos at) noexcept;

  // The force on the hand, frame M.
  void felt(const Wrench& f) noexcept;
  // The slave says which datagram of its session it follows; 0: none yet.
  void reported(std::uint64_t applied) noexcept;

  // The run is over: counts a stop that still lasts.
  void finish() noexcept { stops_.finish(report_); }

  const AuditReport& report() const noexcept { return report_; }
  // Tip of the newest command, and its distance from the newest command delivered [m].
  const Vec3& tip() const noexcept { return joints_.tip(); }
  double behind() const noexcept {
    return master_.any() ? (tip() - master_.newest().X_SU.p).norm() : 0.0;
  }
  bool moving() const noexcept { return joints_.moving(); }
  // How far the tip may go on from the newest command until it rests [m].
  double way_to_rest() const noexcept { return motion_.way_to_rest(joints_); }
  // Whether the arm may move toward the newest command, as of the last cycle.
  bool led() const noexcept { return master_.led(); }

 private:
  void hold_out(Nanos at) noexcept;
  void take_joints() noexcept;

  double most_force_;  // on the hand [N]
  AuditReport report_;
  HeardMaster master_;
  JointAudit joints_;
  TipWay motion_;
  StopAudit stops_;
  PlaceAudit places_;
  ToolAudit tool_;
  bool touched_ = false;
  Vec3 n_S_ = Vec3::Zero();  // out of the surface touched
  std::uint64_t applied_ = 0;
  std::uint32_t applied_of_ = 0;  // incarnation
};

}  // namespace handrail
