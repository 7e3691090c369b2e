// A simulated CR1-571: the controller's end of real-time external control, with an arm behind it.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/melfa/mxt_packet.h"
#include "devices/rig/network.h"
#include "devices/rig/servo_arm.h"

namespace handrail {

struct ControllerOptions {
  ServoArmOptions arm;
  Nanos period = kMxtPeriod;  // > 0
  int time_out_cycles =
      -1;  // MXTTOUT: cycles in a row without a packet that raise an alarm; -1 none
  double drop_share = 0.0;  // share of packets lost, each way, 0 to 1
  std::uint64_t drop_seed = 1;
  // Packets beyond one a cycle wait for the next cycles, in order, instead of being worked off at
  // once: how a real controller does it is not documented.
  bool queues = false;
};

// What stops the arm until an operator resets it.
enum class AlarmKind : std::uint8_t {
  kNone,
  kJointRange,  // target outside the joint's range
  kOverSpeed,   // target further away than the joint gets in a cycle
  kNotFinite,   // NaN or infinity in a command
  kWrongMode,   // a command that is no joint command
  kTimeOut,     // MXTTOUT cycles without a packet
};
const char* describe(AlarmKind kind) noexcept;

struct Alarm {
  AlarmKind kind = AlarmKind::kNone;
  int joint = 0;       // 1 to 6; 0 when no joint is to blame
  double value = 0.0;  // target [rad] or step [rad] that was refused, or cycles
};

struct ControllerCounters {
  std::uint64_t cycles = 0;
  std::uint64_t packets = 0;  // understood, from the session's peer
  std::uint64_t ignored =
      0;  // garbage, strangers, commands outside a session, more than a cycle holds
  std::uint64_t replies = 0;
  std::uint64_t lost_moves =
      0;  // commands to move that the network kept, or a newer one took the place of
};

// Waits for a NULL packet, which opens a session with its sender, then follows that peer's MOVE
// packets in JOINT mode; END, or a NULL from somebody else, closes the session. NULL never moves
// the arm. The packets that came since the last cycle are worked off in the next, or one of them
// (ControllerOptions::queues): the newest MOVE becomes the servos' target, every NULL and MOVE gets
// one reply in the size it came in. END gets none. Without a packet the last target is held.
// Digital outputs are set and read back as the packet says; there are no inputs.
//
// Alarms latch. A real controller's answer to an alarm is not documented beyond its network error,
// so this one does what a driver has to survive: it stops on the last accepted target and stays
// silent until reset_alarm().
//
// Time and bytes are arguments; nothing allocates. All calls are real-time safe.
class Controller {
 public:
  struct Outgoing {
    PeerId to = 0;
    std::array<std::uint8_t, kMxtLong> buffer{};
    std::size_t size = 0;
    std::span<const std::uint8_t> bytes() const noexcept { return {buffer.data(), size}; }
  };
  static constexpr std::size_t kMaxPerCycle = 8;
  static constexpr std::size_t kMaxQueued = 64;  // where they queue
  static constexpr std::size_t kOutputs = 1024;  // digital, from 0; those of the hand begin at 900

  explicit Controller(const ControllerOptions& options) noexcept;

  // A datagram arrives between two cycles.
  void on_datagram(std::span<const std::uint8_t> bytes, PeerId from) noexcept;
  // A datagram that was sent and never arrived: counted, for who judges what did.
  void missed(std::span<const std::uint8_t> bytes) noexcept;
  // Cycles are left out: what waited for them is as lost as what nobody heard.
  void leave_out() noexcept;
  // One control cycle at `now`, which never goes backward. The arm moves by the time since it moved
  // last.
  void tick(Nanos now) noexcept;
  // The arm moves until `now`, between two cycles.
  void pass(Nanos now) noexcept;
  // What the cycle sent; holds until the next one.
  std::span<const Outgoing> replies() const noexcept { return {outgoing_.data(), outgoing_count_}; }

  // Whether the program that opens MXT runs, with the servos on. While it does not, the session is
  // over, nobody is answered and the arm holds.
  void serve(bool on) noexcept;

  const Alarm& alarm() const noexcept { return alarm_; }
  // What the operator's reset button does: the arm holds, a NULL may open a session again.
  void reset_alarm() noexcept { alarm_ = Alarm{}; }
  // The last cycle took over a target.
  bool accepted() const noexcept { return accepted_; }
  // The peer under whose control the arm is.
  std::optional<PeerId> session() const noexcept { return session_; }
  // Cycles in a row without a packet from the session's peer.
  std::uint16_t t_count() const noexcept { return t_count_; }
  // Whether digital output `number`, below kOutputs, is on. It stays so without a session.
  bool output(std::size_t number) const noexcept { return outputs_[number]; }
  ServoArm& arm() noexcept { return arm_; }
  const ServoArm& arm() const noexcept { return arm_; }
  const ControllerCounters& counters() const noexcept { return counters_; }
  const LossySwitch& network() const noexcept { return switch_; }

 private:
  struct Incoming {
    PeerId from = 0;
    std::size_t size = 0;
    MxtParse parse = MxtParse::kOk;
    MxtPacket packet;
  };

  bool serve(const Incoming& in) noexcept;
  void serve_all(std::size_t count) noexcept;
  bool accept_target(const JointVector& q) noexcept;
  void raise(AlarmKind kind, int joint, double value) noexcept;
  void reply(const Incoming& in) noexcept;

  void set_outputs(const MxtIo& io) noexcept;
  MxtIo outputs_for(const MxtIo& asked) const noexcept;

  ControllerOptions options_;
  std::bitset<kOutputs> outputs_;
  ServoArm arm_;
  LossySwitch switch_;
  ControllerCounters counters_;
  Alarm alarm_;
  std::optional<PeerId> session_;
  std::optional<JointVector> next_target_;
  bool accepted_ = false;
  bool serves_ = true;
  std::uint16_t t_count_ = 0;
  std::optional<Nanos> arm_at_;  // until when the arm has moved
  std::array<Incoming, kMaxQueued> incoming_{};
  std::size_t incoming_count_ = 0;  // waiting
  std::array<Outgoing, kMaxPerCycle> outgoing_{};
  std::size_t outgoing_count_ = 0;
};

}  // namespace handrail
