// One end of the link without sockets: bytes and time come in, bytes and answers go out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "server/base/time.h"
#include "server/link/arrivals.h"
#include "server/link/codec.h"
#include "server/link/frame.h"
#include "server/link/refusal_turns.h"
#include "server/link/reject.h"
#include "server/model/link_state.h"

namespace handrail {

inline constexpr Nanos kSendPeriod = kMillisecond;
// How long the present session must have been silent before another may take its place.
inline constexpr Nanos kTakeoverSilence = 200 * kMillisecond;
// How old our newest datagram that the peer answered may be while its session counts as confirmed:
// the longest loop a scene may allow, and two seconds to spare.
inline constexpr Nanos kConfirmedAge = 12 * kSecond;
// How long what a refusal says is believed. Of one who waits alone five in a row may be lost.
inline constexpr Nanos kRefusalStands = kSecond;
// With nothing fresh for longer than this the quality is POOR.
inline constexpr Nanos kPoorAge = 20 * kMillisecond;

using LinkQuality = LinkGrade;

// What one end knows of its link at a moment. Ages grow as the reader's clock does: they are asked
// with `now`.
struct LinkSnapshot {
  std::uint32_t peer_epoch =
      0;  // sessions accepted so far; 0 = none. A change = the peer restarted
  Nanos received_at = -kForever;  // when the newest fresh datagram was accepted
  Nanos peer_sent = 0;            // ... and sent, by the peer's clock
  Nanos echoed_sent = -kForever;  // when the newest of our datagrams the peer confirmed was sent
  Nanos round_trip = -1;          // newest measured, without the time the peer held it; -1 = none
  // How long the peer had had nothing fresh from us when it sent its newest; kForever: nothing yet.
  Nanos peer_age = kForever;
  int received_of_100 = 0;       // of the last 100 that are not possibly still under way
  int peer_received_of_100 = 0;  // the same there, as its newest datagram says
  std::uint64_t sequence = 0;    // of the newest accepted; 0 = none
  double loss_share = 0.0;       // of the same 100, 0 to 1
  std::uint64_t sent = 0;
  std::uint64_t unsendable = 0;  // own states check() refused: a fault of this program
  std::uint64_t withheld = 0;    // datagrams not sent: nothing true to say, or nobody to lead
  std::uint64_t accepted = 0;
  std::uint64_t rejected = 0;
  Nanos refused_at = -kForever;     // when the slave last said that another leads it
  Refusal refusal;                  // what it said
  std::uint8_t other_wire = 0;      // the wire version of a datagram that is not of ours, and
  Nanos other_wire_at = -kForever;  // when the newest came

  // The slave lately said that another master leads it, and nothing else since.
  bool refused(Nanos now) const noexcept;
  // The wire version that the peer lately spoke, and nothing that can be read since; 0: none.
  int other_version(Nanos now) const noexcept;
  // Time since the last fresh datagram; kForever when there was none in this session or any other.
  Nanos age(Nanos now) const noexcept;
  // Age of the newest own datagram the peer is known to have, however long the way there and back:
  // catches constant delay, which age() cannot. kForever when none was confirmed.
  Nanos loop_age(Nanos now) const noexcept;
  // The peer's session has answered this session of ours, lately: it lives, and is no recording of
  // one that spoke to somebody else. Nothing of an unconfirmed session may be obeyed.
  bool confirmed(Nanos now) const noexcept;
  LinkQuality quality(Nanos now) const noexcept;
  // What a step is told of the link.
  LinkView view(Nanos now) const noexcept;
};

// The part of a peer that does not depend on its role. Use LinkPeer.
class PeerCore {
 public:
  explicit PeerCore(std::uint64_t session, std::uint64_t sequence) noexcept
      : session_(session), sequence_(sequence) {}

  // Judges a well-formed datagram from the other side; kNone: it is the newest. Real-time safe.
  Reject accept(const DatagramHeader& header, Nanos now) noexcept;
  // What the sender of a datagram refused for another session's sake, or for its version, is to be
  // told; none: nothing, or it is not its turn. `leader`: whose the present session is.
  std::optional<Refusal> refuse(std::uint64_t session, Reject cause, std::string_view leader,
                                Nanos now) noexcept;
  // Takes what we are told when it is about our session. One that was replaced is over: what is
  // sent from then on begins another.
  Reject take(const Refusal& refusal, Nanos now) noexcept;
  // A datagram was refused for its wire version.
  void hear_version(std::uint8_t version, Nanos now) noexcept;
  void count(Reject cause) noexcept;

  bool can_send() const noexcept { return sequence_ != UINT64_MAX; }
  bool due(Nanos now) const noexcept { return now >= next_due_ && can_send(); }
  // The header of the datagram to send now. Real-time safe.
  DatagramHeader next_header(Nanos now) const noexcept;
  // Moves the schedule on, along its own grid, without making up for what was missed. What was sent
  // before its time takes the place of what would have been next.
  void after_send(Nanos now, bool sent) noexcept;
  void withhold(Nanos now) noexcept;
  Nanos wait_time(Nanos now) const noexcept;

  std::uint64_t session() const noexcept { return session_; }
  const LinkSnapshot& snapshot() const noexcept { return snapshot_; }
  const RejectCounts& rejects() const noexcept { return rejects_; }

 private:
  // A session that another took the place of. One that never answered us may have been real, and
  // may come back with what is newer; an answered one never does.
  struct Replaced {
    std::uint64_t session = 0;
    std::uint64_t newest = 0;
    bool answered = false;
  };
  void move_schedule(Nanos now) noexcept;
  Reject accept_session(const DatagramHeader& header, Nanos now) const noexcept;
  void remember_present() noexcept;
  bool answered() const noexcept { return snapshot_.echoed_sent != -kForever; }
  void take_echo(const DatagramHeader& header, Nanos now) noexcept;

  std::uint64_t session_;
  std::uint64_t sequence_;  // of the last datagram sent
  Nanos next_due_ = -kForever;
  std::uint64_t peer_session_ = 0;
  Nanos peer_since_ = 0;  // when that session was accepted
  Arrivals arrivals_;
  std::array<Replaced, 8> replaced_{};
  std::size_t next_replaced_ = 0;
  Nanos replaced_at_ = -kForever;  // when one session last took another's place
  RefusalTurns turns_;
  LinkSnapshot snapshot_;
  RejectCounts rejects_{};
};

// One end of the link: sends Local, receives Remote. Newest wins: within a session only a rising
// sequence moves the state. Another session is accepted at once when there is none or the present
// one has never answered ours (a recording does not), but then not within 200 ms of the last such
// change; else once the present one has been silent for over 200 ms. Of the eight sessions last
// replaced, those that had answered never come back: a master so replaced is told and begins
// another session, which waits until the present one has been silent.
// No allocation after construction; every method is real-time safe. One thread at a time.
template <typename Local, typename Remote>
class LinkPeer {
 public:
  // `session`: random, not 0 (random_session_id()). `sequence`: that its datagrams rise from; 0 but
  // for a trial of what only ages would bring.
  explicit LinkPeer(std::uint64_t session, std::uint64_t sequence = 0) : core_(session, sequence) {}

  // Takes one datagram. kNone: newest() and snapshot() have moved on; kRefused: snapshot() tells
  // who leads the other side. Otherwise it was counted and nothing else has changed.
  Reject on_datagram(std::span<const std::uint8_t> bytes, Nanos now) noexcept {
    heard_ = bytes.size();
    Reject cause = codec_.decode(bytes, header_, scratch_);
    if (cause == Reject::kNone) cause = core_.accept(header_, now);
    if constexpr (kLeads) {
      if (cause == Reject::kKind) cause = on_refusal(bytes, now);
    }
    if (cause == Reject::kVersion) core_.hear_version(wire_version_of(bytes), now);
    core_.count(cause);
    if (cause == Reject::kNone) newest_ = scratch_;
    return cause;
  }

  // Writes what the sender of the datagram that on_datagram() has just refused for `cause` is to be
  // told, and returns its size, less than that datagram's; 0 = nothing. `leader`: who sent the
  // newest accepted datagram.
  std::size_t refuse(Reject cause, std::string_view leader, Nanos now,
                     std::span<std::uint8_t> out) noexcept {
    if constexpr (kLeads) return 0;
    const auto refusal = core_.refuse(header_.session, cause, leader, now);
    const std::size_t size = refusal ? codec_.encode(*refusal, out) : 0;
    return size < heard_ ? size : 0;
  }

  // Counts a datagram that the transport dropped before it came here.
  void count_dropped(Reject cause) noexcept { core_.count(cause); }

  // Writes the datagram that is due, once a kSendPeriod, and returns its size; 0 = not due, or the
  // state cannot be sent (snapshot().unsendable, last_unsendable()). A stop that was not spoken of
  // before is due at once, in place of the next datagram. `out` holds kMaxDatagram.
  std::size_t poll(Nanos now, const Local& state, std::span<std::uint8_t> out) noexcept {
    if (!core_.due(now) && !(state.stop_epoch != stop_spoken_ && core_.can_send())) return 0;
    stop_spoken_ = state.stop_epoch;
    Reject cause = Reject::kNone;
    const std::size_t size = codec_.encode(core_.next_header(now), state, out, cause);
    if (size == 0) last_unsendable_ = cause;
    core_.after_send(now, size != 0);
    return size;
  }

  // Lets the datagram that is due pass unsent: silence, where there is nothing true to say.
  void withhold(Nanos now) noexcept { core_.withhold(now); }

  // How long poll() has nothing to do [ns]; 0 = due now.
  Nanos wait_time(Nanos now) const noexcept { return core_.wait_time(now); }

  // The newest accepted state; defaults while snapshot().peer_epoch is 0.
  const Remote& newest() const noexcept { return newest_; }
  const LinkSnapshot& snapshot() const noexcept { return core_.snapshot(); }
  const RejectCounts& rejects() const noexcept { return core_.rejects(); }
  Reject last_unsendable() const noexcept { return last_unsendable_; }
  std::uint64_t session() const noexcept { return core_.session(); }

 private:
  static constexpr bool kLeads = std::is_same_v<Local, MasterState>;

  Reject on_refusal(std::span<const std::uint8_t> bytes, Nanos now) noexcept {
    Refusal refusal;
    const Reject cause = codec_.decode(bytes, refusal);
    return cause == Reject::kNone ? core_.take(refusal, now) : cause;
  }

  PeerCore core_;
  Codec codec_;
  DatagramHeader header_;
  Remote scratch_;
  Remote newest_;
  Reject last_unsendable_ = Reject::kNone;
  std::uint64_t stop_spoken_ = 0;
  std::size_t heard_ = 0;  // bytes of the newest datagram, of whatever use
};

using MasterPeer = LinkPeer<MasterState, SlaveState>;
using SlavePeer = LinkPeer<SlaveState, MasterState>;

// The session id a program goes on with once `session` was replaced; as random as that. Real-time
// safe.
std::uint64_t session_after(std::uint64_t session) noexcept;

// A session id from the kernel's random source, never 0. Not real-time safe.
std::uint64_t random_session_id();

}  // namespace handrail
