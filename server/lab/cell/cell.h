// One whole cell in virtual time: the master's and the slave's own steps, the robot driver's
// packets and the simulated rig on one clock, without sockets, threads or sleeping.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>

#include "devices/melfa/mxt_client.h"
#include "devices/rig/rig.h"
#include "server/follow/follow_step.h"
#include "server/haptic/haptic_run.h"
#include "server/lab/cell/cell_keeper.h"
#include "server/lab/cell/cell_net.h"
#include "server/lab/cell/robot_line.h"
#include "server/lab/cell/wire.h"

namespace handrail {

struct CellOptions {
  HapticSettings haptic;
  FollowSettings follow;
  RigOptions rig;
  // Of the master's loop, 0.1 to 10 ms. The smoother in `haptic` counts ticks, not time.
  Nanos tick = kMillisecond;
  Nanos transit = 0;  // one-way time of the link, on top of waiting for the next tick or cycle
  // Instead of `transit`: the daemons' peers and datagrams over a made-up network. The tick is 1
  // ms.
  std::optional<CellNetOptions> net;
  // The packets between the slave and the controller go over a made-up line of that seed; none: at
  // once.
  std::optional<std::uint64_t> robot_line;
  std::size_t packet_bytes = kMxtLong;  // to the controller and back
  // With a net: that stops, faults and engagements are counted from; none: each program's session.
  std::optional<std::uint64_t> epoch;
};

// What the controller did in one of its cycles.
struct ControllerCycle {
  Nanos at = 0;
  bool took = false;                    // a target, perhaps the one it held
  JointVector q = JointVector::Zero();  // the target it holds from then on [rad]
};

// Comes between the rig and the slave's step, to falsify what its devices say.
class CellTap {
 public:
  virtual ~CellTap() = default;
  // A reading of the force sensor, as the driver passes it on.
  virtual void on_force(Nanos, Wrench&, bool& /*valid*/) noexcept {}
  // A reply of the controller.
  virtual void on_reply(Nanos, RobotReply&) noexcept {}
};

// Same options, hands and orders: same answers, bit for bit. The master sends its state once a
// tick, the slave its own once a millisecond, whatever the tick. Large: keep it on the heap.
class Cell {
 public:
  explicit Cell(const CellOptions& options);

  // Lets one master tick pass: first what the rig and the slave do until then, then the master's
  // step with this hand and order. Allocates nothing.
  void tick(const HandReading& hand, const HapticOrder& order = {}) noexcept;

  Nanos now() const noexcept { return now_; }
  const HapticOutput& master() const noexcept { return run_.result().out; }
  const HapticInput& master_input() const noexcept { return given_.in; }
  const HapticState& master_state() const noexcept { return run_.state(); }
  const SlaveState& slave() const noexcept { return follow_out_.link; }
  const Rig& rig() const noexcept { return rig_; }
  // True when the robot's controller ran a cycle during the last tick: the arm has moved.
  bool robot_cycle() const noexcept { return robot_cycle_; }
  // When the newest cycle ran, and so when the arm stood where the rig shows it; 0 before the
  // first. A tick longer than the controller's period can hold two cycles.
  Nanos robot_cycle_at() const noexcept { return robot_cycle_at_; }
  // The joint targets in the datagrams sent to the controller during the last tick, as read back
  // from their bytes [rad].
  std::span<const JointVector> sent() const noexcept { return {sent_.data(), sent_count_}; }
  // The targets the slave's step gave in the cycles of the last tick, before they were rounded to
  // the packets' 32 bits, as far as they were sent [rad].
  std::span<const JointVector> targets() const noexcept { return {targets_.data(), target_count_}; }
  // When the newest of them was given; 0 before the first.
  Nanos target_at() const noexcept { return target_at_; }
  // The controller's cycles of the last tick.
  std::span<const ControllerCycle> controller_cycles() const noexcept {
    return {controller_cycles_.data(), controller_cycle_count_};
  }

  // Null without a line of its own.
  RobotLine* robot_line() noexcept { return line_.get(); }
  const MxtCounters& robot_counters() const noexcept { return client_.counters(); }
  // Null without a net.
  CellNet* net() noexcept { return net_.get(); }
  const FollowOutput& follow() const noexcept { return follow_out_; }
  const FollowState& follow_state() const noexcept { return follow_; }
  // Not owned; null: none.
  void set_tap(CellTap* tap) noexcept { tap_ = tap; }
  // What both steps are given and what comes of it is left there, from now on, as the daemons leave
  // it. Not owned. Before the first tick.
  void keep(MasterTap* master, SlaveTap* slave) noexcept { keeper_.keep(master, slave); }
  // The master's haptic thread stands still while its IO thread goes on.
  void stall_master(bool stalled) noexcept { master_stalled_ = stalled; }
  // Goes out instead of what the master's step gives, while not null. Not owned.
  void send_instead(const MasterState* state) noexcept { instead_ = state; }
  // The slave's local stop circuit. Opened between two cycles it counts for the next one.
  void open_stop_circuit(bool open) noexcept {
    stop_open_ = open;
    follow_in_.stop_input |= open;
  }
  // The program is killed and started anew, with a net only. Allocates.
  void restart_master();
  void restart_slave();

 private:
  void begin_master() noexcept;
  void begin_slave() noexcept;
  void run_rig() noexcept;
  void step_master(const HandReading& hand, const HapticOrder& order) noexcept;
  void hear_slave() noexcept;
  void hear_master(Nanos at) noexcept;
  void on_control(Nanos at) noexcept;
  bool slave_stopped() const noexcept { return net_ && net_->slave_stopped(); }
  Nanos robot_due() const noexcept;
  void run_line(Nanos at) noexcept;
  void on_event(RobotEvent event, Nanos at) noexcept;
  void read_sensor(Nanos at) noexcept;
  void to_controller(MxtClient::Bytes bytes) noexcept;

  CellOptions options_;
  Rig rig_;
  MxtClient client_;
  HapticRun run_;
  HapticTick given_;
  FollowState follow_;
  FollowInput follow_in_;
  FollowOutput follow_out_;
  Wire<MasterState> to_slave_;
  Wire<SlaveState> to_master_;
  std::unique_ptr<CellNet> net_;
  CellTap* tap_ = nullptr;
  CellKeeper keeper_;
  const MasterState* instead_ = nullptr;
  std::unique_ptr<RobotLine> line_;
  RobotReply reply_;
  std::array<ControllerCycle, 4> controller_cycles_;
  std::size_t controller_cycle_count_ = 0;
  Nanos at_ = 0;  // of the newest event
  Nanos target_at_ = 0;
  Nanos stepped_at_ = 0;  // the slave's step
  Nanos master_at_ = 0;   // the master's
  std::array<JointVector, 4> sent_;
  std::size_t sent_count_ = 0;
  std::array<JointVector, 4> targets_;
  std::size_t target_count_ = 0;
  Nanos haptic_made_ = 0;  // when the newest states were made
  Nanos follow_made_ = 0;
  Nanos repeat_next_ = 0;  // when the slave's IO sends next
  Nanos robot_cycle_at_ = 0;
  bool robot_cycle_ = false;
  bool master_stalled_ = false;
  bool stop_open_ = false;
  Nanos now_ = 0;
};

}  // namespace handrail
