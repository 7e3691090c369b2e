// The judge of a fault run. It sees the joint commands, the force on the hand and the network's
// truth, nothing of what master or slave think.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/lab/cell/virtual_link.h"
#include "server/lab/faults/joint_audit.h"
#include "server/model/link_state.h"
#include "server/model/tip_space.h"

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

  std::uint64_t total() const noexcept;
  std::uint64_t of(Breach breach) const noexcept {
    return breaches[static_cast<std::size_t>(breach)];
  }
};

// Call everything in the order of time. Between two events what the master sent and what was
// delivered comes first, then the command of the cycle. Real-time safe but for construction.
class Auditor {
 public:
  // How long after the last fresh datagram a stop is due, and when it needs an operator.
  static constexpr Nanos kWatchdog = 20 * kMillisecond;
  static constexpr Nanos kLatch = 200 * kMillisecond;
  // Of the stop bound beside the joints' own time: one cycle and 2 ms.
  static constexpr Nanos kOverhead = 2 * kMillisecond;
  // A tip further from all recent commands than this, and than its own stop takes it where they
  // turn before it, goes where nobody sent it [m].
  static constexpr double kRoom = 0.005;
  static constexpr double kOffTool = 1e-5;  // [m]

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
  void must_stop(Nanos at) noexcept;
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
  void finish() noexcept;

  const AuditReport& report() const noexcept { return report_; }
  // Tip of the newest command, and its distance from the newest command delivered [m].
  const Vec3& tip() const noexcept { return joints_.tip(); }
  double behind() const noexcept { return heard_ ? (tip() - newest_.X_SU.p).norm() : 0.0; }
  bool moving() const noexcept { return joints_.moving(); }
  // How far the tip may go on from the newest command until it rests [m].
  double way_to_rest() const noexcept;
  // Whether the arm may move toward the newest command, as of the last cycle.
  bool led() const noexcept { return led_; }

 private:
  static constexpr std::size_t kRemembered = 8192;  // of what is replayed, 4096 back at most
  static constexpr std::size_t kBuckets = 21;       // of the recent commands' places
  static constexpr Nanos kBucket = 100 * kMillisecond;

  struct Sent {
    std::uint64_t number = 0;
    std::uint32_t incarnation = 0;
    bool drives = false;    // engaged or clutched, and wanted
    bool stops = false;     // a stop stands
    bool aligning = false;  // asks to engage
    bool has_command = false;
    bool repeated = false;
    Pose X_SU;
    ToolDefinition tool;
  };
  struct Box {
    Nanos from = -kForever;
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();
  };

  void breach(Breach kind) noexcept { ++report_.breaches[static_cast<std::size_t>(kind)]; }
  bool stop_is_due(Nanos at) const noexcept { return must_stop_ && at >= must_stop_at_; }
  void check_led(Nanos at) noexcept;
  void begin_stop(Nanos at) noexcept;
  void end_stop() noexcept;
  void record_stop() noexcept;
  void check_place(Nanos at) noexcept;
  bool in_reach(const Pose& X) const noexcept;
  void take_tool(const Sent& entry) noexcept;
  void check_tool() noexcept;
  void hold_out(Nanos at) noexcept;
  void remember_stop() noexcept;
  bool too_far(double off) const noexcept;
  void reach_of_tool() noexcept;
  double even_way() const noexcept;
  void remember_place(const Vec3& p, Nanos at) noexcept;

  AuditLimits limits_;
  double dt_;
  AuditReport report_;
  std::vector<Sent> sent_;

  Sent newest_;  // newest fresh
  bool heard_ = false;
  Nanos heard_at_ = -kForever;
  Nanos told_at_ = 0;       // when a fresh one first said no longer to move
  bool must_stop_ = false;  // from must_stop_at_ on
  Nanos must_stop_at_ = 0;
  bool latched_ = false;

  JointAudit joints_;
  bool led_ = false;
  Vec3 rest_ = Vec3::Zero();  // where the tip last stood

  bool stopping_ = false;
  bool stop_while_moving_ = false;
  bool stop_needs_operator_ = false;
  Nanos stop_from_ = 0;
  Nanos last_moved_ = 0;
  Nanos stop_allowed_ = 0;

  std::array<Box, kBuckets> boxes_{};
  std::array<Vec3, 3> tips_{};  // of the last commands, newest first
  JointAudit last_asked_;       // when the tip was last where it was asked to be
  double even_way_ = 0.0;       // then [m]
  bool beyond_reach_ = false;   // as of the last command
  Pose asked_;                  // then
  double gap_ = 1e9;            // from it to the tip, at most [m]
  double stop_time_ = 0.0;      // that the joints needed at the last command [s]
  ToolDefinition tool_;
  std::uint32_t tool_of_ = 0;  // incarnation
  TipSpace space_;
  bool tool_new_ = false;    // since the last command
  double tool_reach_ = 0.0;  // the tip goes no further from the tool [m]
  bool touched_ = false;
  Vec3 n_S_ = Vec3::Zero();  // out of the surface touched
  std::uint64_t applied_ = 0;
  std::uint32_t applied_of_ = 0;  // incarnation
};

}  // namespace handrail
