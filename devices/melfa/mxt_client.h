// The PC's side of MELFA real-time external control as a pure state machine: time and bytes are
// arguments, packets to send are return values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/melfa/mxt_packet.h"
#include "devices/robot.h"

namespace handrail {

struct MxtClientOptions {
  std::size_t packet_bytes = kMxtLong;  // kMxtShort or kMxtLong; replies must have the same size
  Nanos period = kMxtPeriod;            // the controller's cycle, > 0
  int max_losses = 100;                 // missed replies in a row that end the session, > 0
  // Replies closer together than this belong to one control cycle: a repeated packet or a
  // duplicating network brings twins, and two commands in one cycle could be twice the step a joint
  // can make.
  Nanos same_cycle = kMxtPeriod / 4;
};

struct MxtCounters {
  std::uint64_t sent = 0;      // packets of any kind
  std::uint64_t replies = 0;   // replies accepted
  std::uint64_t repeats = 0;   // packets sent again after silence, among `sent`
  std::uint64_t rejected = 0;  // packets of wrong size, type or value
  std::uint64_t twins = 0;     // replies beyond the first of a control cycle
};

// One session: start(), then a send() for every reply, poll() whenever deadline() has passed,
// end(). Spans returned point into the client and hold until its next call. All calls are real-time
// safe.
class MxtClient {
 public:
  using Bytes = std::span<const std::uint8_t>;

  explicit MxtClient(const MxtClientOptions& options) noexcept : options_(options) {}

  // Opens a session (again): the packet that asks for the current joints and moves nothing.
  Bytes start(Nanos now) noexcept;

  // Reads one datagram from the controller. kReply: `reply` is filled. Nothing: a twin of the reply
  // before; `reply` is brought up to date, but there is no new cycle to command. kRejected: dropped
  // and counted, `reply` untouched. kLost: no session is open. The packet counter in the reply is
  // not used, as controllers differ in what they put there.
  std::optional<RobotEvent> on_datagram(Bytes bytes, Nanos now, RobotReply& reply) noexcept;

  // Before deadline(): nothing. After it: kSilence with packet() to be sent again, or kLost when
  // that was the last loss allowed or no session is open.
  std::optional<RobotEvent> poll(Nanos now) noexcept;

  // The packet for one absolute target [rad], finite. Empty when no session is open. Until the
  // first send() of a session what poll() repeats is the opening packet: nothing moves before a
  // command.
  Bytes send(const JointVector& q_target) noexcept;

  // The packet that ends external control, and closes the session. Empty when none is open.
  Bytes end() noexcept;

  // The packet last given out.
  Bytes packet() const noexcept { return packet_; }
  // When silence becomes a loss: two periods after the newest reply or repeat.
  Nanos deadline() const noexcept { return deadline_; }
  bool open() const noexcept { return open_; }
  const MxtCounters& counters() const noexcept { return counters_; }

 private:
  Bytes write(MxtCommand command) noexcept;

  MxtClientOptions options_;
  MxtCounters counters_;
  bool open_ = false;
  MxtCommand held_command_ = MxtCommand::kNull;
  JointVector q_held_ = JointVector::Zero();
  int losses_ = 0;
  std::uint32_t c_count_ = 0;
  Nanos deadline_ = kForever;
  Nanos last_reply_ = -kForever;
  std::array<std::uint8_t, kMxtLong> buffer_{};
  Bytes packet_;
};

}  // namespace handrail
