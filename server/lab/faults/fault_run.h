// One run of a fault row: a cell over a made-up network, a hand that moves, an operator, an
// auditor.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "server/lab/cell/cell.h"
#include "server/lab/faults/audit/auditor.h"
#include "server/lab/faults/audit/controller_audit.h"
#include "server/lab/faults/fault_cell.h"

namespace handrail {

inline HapticOrder order_of(OrderKind kind) {
  HapticOrder order;
  order.kind = kind;
  return order;
}

// What a run has come to. `worst` and `bound` are in the row's unit and mean something if
// `measured`; violations count whatever the auditor and the row's own judge found.
struct FaultOutcome {
  std::uint64_t violations = 0;
  bool measured = false;  // a run without a stop has no time to stop
  double worst = 0.0;
  double bound = 0.0;
  std::string found;  // names of the violations, for people
  // How long the arm's joints went on after the last command of a stop, at most [ms].
  double settled = 0.0;
  // In contact: how much more the surface pushed, and how much further in the arm's joints stood,
  // after a stop had set in than when it did, at most [N], [mm].
  double harder = 0.0;
  double deeper = 0.0;
};

// What a run of a row is given.
struct RowRun {
  std::uint64_t seed = 1;  // of this run alone
  int index = 0;           // which of the row's runs
  double share = 1.0;      // of the long spans, 0 to 1
  // It is recorded as the daemons record, and done again: what differs is a violation.
  bool replay = false;

  // Of a row whose runs take their levels in turn.
  template <typename T, std::size_t n>
  const T& level(const std::array<T, n>& levels) const {
    return levels[static_cast<std::size_t>(index) % n];
  }
  Nanos span(Nanos longest) const {
    return static_cast<Nanos>(share * static_cast<double>(longest));
  }
  // Another run of the same.
  RowRun next() const {
    RowRun out = *this;
    ++out.seed;
    return out;
  }
};

// Faults of the devices: called with what the device says and when, they may change it. Empty:
// none.
struct FaultLayers final : public CellTap {
  std::function<void(Nanos, Wrench&, bool&)> force;
  std::function<void(Nanos, RobotReply&)> reply;
  std::function<void(const RobotReply&)> heard;  // as it is passed on
  std::function<void(Nanos, HandReading&)> hand;

  void on_force(Nanos at, Wrench& f, bool& valid) noexcept override {
    if (force) force(at, f, valid);
  }
  void on_reply(Nanos at, RobotReply& told) noexcept override {
    if (reply) reply(at, told);
    if (heard) heard(told);
  }
};

// Same seed, same calls: same bits. The hand's motion and the network are drawn from the seed.
class FaultRun {
 public:
  explicit FaultRun(const RowRun& row, const FaultOptions& options = {});

  LinkFaults& to_slave() { return cell_->net()->link().to_slave().faults; }
  LinkFaults& to_master() { return cell_->net()->link().to_master().faults; }
  // Both ways alike.
  void set_network(const LinkFaults& faults);

  // Engages, with patience for ten seconds, and drives for a second. False: it did not.
  bool engage();
  // Lets `span` pass. drive(): with an operator who resets and engages again whenever needed.
  void run(Nanos span);
  void drive(Nanos span);
  void tick(const HapticOrder& order = {});

  // What the line between slave and controller does. From the first call on the arm may be halted,
  // and is judged by what the controller accepts alone.
  void set_robot_line(const LinkFaults& commands, const LinkFaults& replies);
  // A program that is paused halts the arm with reason.
  void let_pause() { may_halt_ = paused_ = true; }
  // Motions that ended without braking, as the controller saw them.
  std::uint64_t halts() const { return controller_.halts(); }
  // Of them, those that had no reason: the next target was in a rated step of all that the
  // controller might hold.
  std::uint64_t halts_in_vain() const { return halts_in_vain_; }
  const ControllerAudit& controller() const { return controller_; }
  // A poor link: the arm need not go on whenever something fresh comes.
  void let_hold() { may_hold_ = true; }
  void stall_master(bool stalled);
  void restart_master();
  // Goes out instead of what the master's step gives, while not null. Not owned.
  void send_instead(const MasterState* state);
  Random& random() { return random_; }
  // A time of 0 to `most`, drawn from random().
  Nanos up_to(Nanos most) {
    return static_cast<Nanos>(random_.uniform() * static_cast<double>(most));
  }

  Cell& cell() { return *cell_; }
  Auditor& auditor() { return auditor_; }
  FaultLayers& layers() { return layers_; }
  Nanos now() const { return cell_->now(); }
  // What the surface truly exerts along its normal; 0 without one [N].
  double true_force() const;
  // When the newest datagram of the slave reached the master.
  Nanos master_heard() const { return master_heard_; }
  // Ticks in which the arm was not engaged although the auditor had let it move for half a second.
  std::uint64_t not_resumed() const { return not_resumed_; }
  // Age of the newest datagram of the master that the slave had answered when it sent what last
  // reached the master: what the master should take for its loop's age. kForever: none yet.
  Nanos loop_age() const { return answered_ < 0 ? kForever : now() - answered_; }
  // Root of the mean squared distance of the arm's commands from what the master commands [m].
  double tracking_error() const;
  // Longest time between two fresh datagrams at the slave since engage().
  Nanos longest_gap() const { return longest_gap_; }
  bool engaged() const;

  // The stop with the least time left [ms], and everything found so far.
  FaultOutcome outcome();

 private:
  void feed_auditor();
  void feed_controller_audit();
  void judge_halt(const std::vector<JointVector>& maybe_held, const JointVector& next);
  void sent_target(const JointVector& q, Nanos at);
  JointVector as_before(const JointVector& q) const;
  void hear_controller(const RobotReply& reply);
  JointVector as_sent(const JointVector& q);
  std::vector<JointVector>::iterator nearest_held(const JointVector& q);
  void follow_loop();
  void watch_servo();
  void watch_surface();
  HandReading hand_now();

  Random random_;
  std::unique_ptr<Cell> cell_;
  std::unique_ptr<FaultRecording> recording_;
  Auditor auditor_;
  ControllerAudit controller_;
  bool may_halt_ = false;
  bool paused_ = false;
  std::array<JointVector, 2> targets_{};  // sent last, newest first
  std::vector<JointVector> maybe_held_;   // the last confirmed, and what was sent since
  std::uint64_t halts_in_vain_ = 0;
  std::uint64_t told_halts_ = 0;
  Nanos sent_at_ = -1;  // the first target since the controller took one; -1: none
  FaultLayers layers_;
  std::array<double, 12> hand_{};  // amplitudes, rates and phases
  std::uint32_t incarnation_ = 1;
  std::uint64_t sent_ = 0;
  bool stalled_ = false;
  const MasterState* instead_ = nullptr;
  Nanos next_order_ = 0;
  Nanos master_heard_ = 0;
  Nanos last_fresh_ = -1;
  std::uint64_t fresh_ = 0;
  Nanos longest_gap_ = 0;
  Nanos led_since_ = -1;
  std::uint64_t not_resumed_ = 0;
  bool may_hold_ = false;

  // Of the last so many datagrams, by number: when the master's was sent, what the slave's answers.
  static constexpr std::size_t kLoop = 8192;
  std::vector<Nanos> master_sent_ = std::vector<Nanos>(kLoop);
  std::vector<Nanos> slave_answers_ = std::vector<Nanos>(kLoop, -1);
  Nanos slave_knows_ = -1;
  std::uint64_t slave_sent_ = 0;
  Nanos answered_ = -1;

  double error_squared_ = 0.0;
  std::uint64_t errors_ = 0;
  JointVector q_arm_ = JointVector::Zero();
  Nanos stood_since_ = -1;  // commands
  double settled_ = 0.0;
  double force_led_ = 0.0;    // when the arm was engaged last [N]
  double height_led_ = -1e9;  // of the tip then by the joints, along the normal [m]
  double harder_ = 0.0;       // [N]
  double deeper_ = 0.0;       // [m]
};

// What the run has measured, in the row's unit.
void measure(FaultOutcome& outcome, double worst, double bound);

// Adds `count` violations called `what`.
void find(FaultOutcome& outcome, std::uint64_t count, const char* what);
// Adds what differs in a replay, and what could not be done again.
void find(FaultOutcome& outcome, const FaultRecording::Again& again);

}  // namespace handrail
