// The PC's side of MELFA real-time external control as a pure state machine: time and bytes are
// arguments, packets to send are return values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/melfa/mxt_gripper.h"
#include "devices/melfa/mxt_packet.h"
#include "devices/robot.h"

namespace handrail {

struct MxtClientOptions {
  std::size_t packet_bytes = kMxtLong;  // kMxtShort or kMxtLong; replies must have the same size
  Nanos period = kMxtPeriod;            // the controller's cycle, > 0
  int max_losses = 211;                 // silent cycles in a row that end the session, > 0
  std::optional<MxtGripper> gripper{};  // none: outputs are neither set nor read

  // To the controller and back, over which a session opens.
  Nanos longest_way() const noexcept;
};

struct MxtCounters {
  std::uint64_t sent = 0;      // packets of any kind
  std::uint64_t replies = 0;   // replies accepted
  std::uint64_t silences = 0;  // cycles passed without a reply in time
  std::uint64_t rejected = 0;  // packets of wrong size, type or value
  std::uint64_t late = 0;      // replies that came when their cycle had its packet already
  std::uint64_t far = 0;       // replies to a second packet that came a cycle too late
};

// One session: start(), then one send() for every kReply and kSilence, poll() whenever deadline()
// has passed, end(). Spans returned point into the client and hold until its next call. All calls
// are real-time safe.
//
// The controller's cycles are reckoned on: replies are sent at their beginning and come late or
// never, so the earliest of the last ones tell the phase. Each cycle is one event and gets one
// packet: with the reply if that comes before an eighth of the cycle is left, else without. A reply
// that comes later, or twice, only brings `reply` up to date.
//
// A session opens with four packets that move nothing. The first asks for the measured joints
// first, the others for the target held. These are sent as late in their cycles as any will be, and
// each has to be answered in the next: what is sent without a reply is then in time. Where the way
// there and back is too long for that, packets without a reply are sent when half the cycle is
// left; where it is too long for that too, by 3.1 ms, the session does not open.
//
// After 14 silent cycles the controller may be another one. It is asked in each cycle, and told
// nothing, until its replies agree: each is a vote for a phase or against it, one that comes
// earlier in the cycle begins the count anew, and eight votes decide.
//
// A reply of the short form says where the arm is measured or which target is held, as its packet
// asked. Packets ask for the measured joints, and these mean that the packet's target was taken: no
// other packet waits for such a reply, and a repetition is known by its joints. After a reply that
// is missing, or one too many, three packets ask for the target instead.
class MxtClient {
 public:
  using Bytes = std::span<const std::uint8_t>;

  explicit MxtClient(const MxtClientOptions& options) noexcept : options_(options) {}

  // Opens a session (again): the first packet, which asks for the current joints and moves nothing.
  // Until the last reply of the opening nothing is said of the arm.
  Bytes start(Nanos now) noexcept;

  // Reads one datagram from the controller. kReply: a cycle has begun. Nothing: no other cycle, but
  // `reply` is brought up to date. kRejected: dropped and counted, `reply` untouched. kLost: no
  // session is open. The packet counter in the reply is not used, as controllers differ in what
  // they put there.
  std::optional<RobotEvent> on_datagram(Bytes bytes, Nanos now, RobotReply& reply) noexcept;

  // Before deadline(), and where it is too late for this cycle's packet: nothing. After it:
  // kSilence, or kLost when that was the last loss allowed or no session is open. While opening(),
  // packet() is to be sent with kSilence.
  std::optional<RobotEvent> poll(Nanos now, RobotReply& reply) noexcept;

  // The packet for one absolute target [rad], finite. Empty when no session is open, while
  // opening(), or when it is so late, a 32nd of a period after deadline(), that the packet may miss
  // its cycle.
  Bytes send(const JointVector& q_target, Nanos now) noexcept;

  // The packet that asks which target the controller holds; in the short form, which has room for
  // one answer, the measured joints are left out of the reply. Empty when no session is open, or
  // while opening().
  Bytes ask() noexcept;

  // What every packet from the next on says of the gripper, if there is one. One that opens a
  // session says nothing of it.
  void grip(Grip wanted) noexcept { grip_ = wanted; }

  // The packet that ends external control, and closes the session. Empty when none is open.
  Bytes end() noexcept;

  // The packet last given out.
  Bytes packet() const noexcept { return packet_; }
  // When the next cycle counts as silent: an eighth of a period before the packet has to be there,
  // or half of one over a long way. While opening(): when that goes on.
  Nanos deadline() const noexcept { return deadline_; }
  bool open() const noexcept { return open_; }
  // A session is open, and the replies that open it, or that find the phase anew, have not come.
  bool opening() const noexcept { return open_ && (!answered_ || anew_); }
  const MxtCounters& counters() const noexcept { return counters_; }

 private:
  // Replies with measured joints among which a repetition is sought.
  static constexpr std::size_t kKnown = 4;

  enum class Opening : std::uint8_t {
    kAsked,       // the first packet is sent
    kHeard,       // its reply is here
    kAskedAgain,  // a second packet is sent
    kGivenUp,     // not answered in time; what may be on its way is waited for
  };

  // What the present cycle's packet asks of the arm.
  enum class Told : std::uint8_t {
    kNothing,  // none is sent, or one without a target
    kSame,     // a target that may be held already
    kNew,      // another one
  };

  bool short_form() const noexcept { return options_.packet_bytes == kMxtShort; }
  bool taken(const JointVector& q_measured) noexcept;
  bool hear(const JointVector* q_measured, bool commanded, RobotReply& reply) noexcept;
  Nanos most_early(bool took) const noexcept;
  Bytes write(MxtCommand command, const JointVector& q_target = JointVector::Zero()) noexcept;
  Nanos spare() const noexcept;
  int cycles_begun(Nanos now) const noexcept;
  bool too_late(int cycles, Nanos now) const noexcept;
  bool put_off(int cycles, bool proven, Nanos now) noexcept;
  void begin_cycle(int cycles, Nanos now, RobotReply& reply) noexcept;
  void find_phase(Nanos now) noexcept;
  bool learn_phase(Nanos late, bool may_begin) noexcept;
  void forget_phase() noexcept;
  bool lost() noexcept;
  bool hear_opening(bool second, Nanos now) noexcept;
  bool hear_anew(Nanos now) noexcept;
  void begin_try(Nanos now) noexcept;
  std::optional<RobotEvent> poll_opening(Nanos now) noexcept;
  void give_up_opening(Nanos now) noexcept;

  MxtClientOptions options_;
  MxtCounters counters_;
  Grip grip_ = Grip::kAsItIs;
  bool open_ = false;
  bool answered_ = false;  // the session has opened
  bool anew_ = false;      // it may be another controller, and where its cycles begin is not known
  Opening opening_ = Opening::kAsked;
  Nanos first_ = 0;            // reply of the opening, or of a try of it
  int tries_ = 0;              // whose second reply came too late
  int in_time_ = 0;            // second replies in a row that were
  bool repeated_ = false;      // the first packet of the opening, unanswered as it was
  bool has_measured_ = false;  // said since the last event
  bool has_commanded_ = false;
  bool cycle_answered_ = false;
  Told told_ = Told::kNothing;
  int losses_ = 0;
  std::uint32_t c_count_ = 0;
  Nanos deadline_ = kForever;
  Nanos cycle_ = 0;              // when the present cycle began
  Nanos least_late_ = kForever;  // replies behind their cycle's beginning, of the last `seen_`
  int seen_ = 0;
  Nanos run_late_ = 0;                        // of the first of those in a row that are alike
  int alike_ = 0;                             // how many these are
  bool held_ = false;                         // the controller has said that it holds `q_sent_`
  JointVector q_sent_ = JointVector::Zero();  // the last target, in 32 bits [rad]
  JointVector q_held_ = JointVector::Zero();  // the last one that it has said it holds [rad]
  // Of the short form.
  int doubt_ = 0;                            // packets to come that ask for the target
  bool asked_measured_ = false;              // the packet last sent did, and has no reply yet
  std::array<JointVector, kKnown> q_heard_;  // measured, of the last replies [rad]
  std::size_t heard_next_ = 0;
  std::array<std::uint8_t, kMxtLong> buffer_{};
  Bytes packet_;
};

}  // namespace handrail
