#include "server/link/peer.h"

#include <algorithm>
#include <random>

#include "server/base/deletable.h"
#include "server/base/random.h"

namespace handrail {

int LinkSnapshot::other_version(Nanos now) const noexcept {
  return other_wire_at > received_at && now - other_wire_at <= kRefusalStands ? other_wire : 0;
}

Nanos LinkSnapshot::age(Nanos now) const noexcept {
  return received_at == -kForever ? kForever : std::max<Nanos>(now - received_at, 0);
}

Nanos LinkSnapshot::loop_age(Nanos now) const noexcept {
  return echoed_sent == -kForever ? kForever : std::max<Nanos>(now - echoed_sent, 0);
}

bool LinkSnapshot::confirmed(Nanos now) const noexcept { return loop_age(now) <= kConfirmedAge; }

bool LinkSnapshot::refused(Nanos now) const noexcept {
  return refused_at > received_at && now - refused_at <= kRefusalStands;
}

LinkQuality LinkSnapshot::quality(Nanos now) const noexcept {
  return age(now) > kPoorAge && kept(Check::kWatchdog) ? LinkQuality::kPoor
                                                       : grade_of(received_of_100);
}

LinkView LinkSnapshot::view(Nanos now) const noexcept {
  return {loop_age(now),        peer_age,       received_of_100,
          peer_received_of_100, confirmed(now), refused(now)};
}

Reject PeerCore::accept_session(const DatagramHeader& header, Nanos now) const noexcept {
  if (header.session == session_) return Reject::kHeader;
  for (const Replaced& old : replaced_) {
    if (old.session != header.session) continue;
    if (old.answered) return Reject::kSessionRetired;
    if (header.sequence <= old.newest) return Reject::kStale;
  }
  if (peer_session_ == 0) return Reject::kNone;
  // Who is here for less has not had the time to answer.
  const bool unproven = !answered() && now - replaced_at_ > kTakeoverSilence;
  const bool silent = snapshot_.age(now) > kTakeoverSilence;
  const bool free = silent || unproven || !kept(Check::kOneMaster);
  return free ? Reject::kNone : Reject::kSessionBusy;
}

void PeerCore::remember_present() noexcept {
  auto slot = std::find_if(replaced_.begin(), replaced_.end(),
                           [this](const Replaced& r) { return r.session == peer_session_; });
  if (slot == replaced_.end()) {
    slot = replaced_.begin() + static_cast<std::ptrdiff_t>(next_replaced_);
    next_replaced_ = (next_replaced_ + 1) % replaced_.size();
  }
  *slot = {peer_session_, arrivals_.newest(), answered()};
}

Reject PeerCore::accept(const DatagramHeader& header, Nanos now) noexcept {
  if (header.session == peer_session_) {
    const Reject order = arrivals_.add(header.sequence);
    snapshot_.received_of_100 = arrivals_.received();
    snapshot_.loss_share = arrivals_.loss_share();
    if (order != Reject::kNone && kept(Check::kSequence)) return order;
  } else {
    const Reject cause = accept_session(header, now);
    if (cause != Reject::kNone) return cause;
    if (peer_session_ != 0) {
      remember_present();
      replaced_at_ = now;
    }
    peer_session_ = header.session;
    peer_since_ = now;
    ++snapshot_.peer_epoch;
    arrivals_.restart(header.sequence);
    snapshot_.received_of_100 = arrivals_.received();
    snapshot_.loss_share = arrivals_.loss_share();
    snapshot_.echoed_sent = -kForever;
    snapshot_.round_trip = -1;
  }
  snapshot_.peer_sent = header.sent;
  snapshot_.sequence = header.sequence;
  snapshot_.peer_received_of_100 = static_cast<int>(header.received_of_100);
  snapshot_.received_at = now;
  take_echo(header, now);
  return Reject::kNone;
}

// An echo of another incarnation of ours, or one that cannot be true, says nothing about the way.
// What is held longer than it was under way is true all the same: both times are read before the
// work that they are used for, and a thread that does not run in between makes the one too long or
// the other too short. What it bounds is the age: what is echoed came after we had sent it.
void PeerCore::take_echo(const DatagramHeader& header, Nanos now) noexcept {
  snapshot_.peer_age = kForever;
  if (header.echo_session != session_ || header.echo_sequence > sequence_) return;
  if (header.echo_sent > now || header.echo_sent < snapshot_.echoed_sent) return;
  const Nanos loop = now - header.echo_sent;
  snapshot_.peer_age = std::min(header.echo_held, loop);
  snapshot_.echoed_sent = header.echo_sent;
  if (header.echo_held <= loop) snapshot_.round_trip = loop - header.echo_held;
}

std::optional<Refusal> PeerCore::refuse(std::uint64_t session, Reject cause,
                                        std::string_view leader, Nanos now) noexcept {
  // It can read no more of the answer than its version. Nobody's session, so that who can is not
  // told anything.
  if (cause == Reject::kVersion) {
    if (!turns_.take(kOfOtherVersion, now)) return std::nullopt;
    return Refusal{kOfOtherVersion, false, fixed_text<LeaderName>("another version"), 0};
  }
  const bool led = cause == Reject::kSessionBusy || cause == Reject::kSessionRetired;
  if (!led || leader.empty() || !turns_.take(session, now)) return std::nullopt;
  return Refusal{session, cause == Reject::kSessionRetired, fixed_text<LeaderName>(leader),
                 now - peer_since_};
}

Reject PeerCore::take(const Refusal& refusal, Nanos now) noexcept {
  if (refusal.refused_session != session_) return Reject::kStale;
  snapshot_.refused_at = now;
  snapshot_.refusal = refusal;
  if (refusal.retired) {
    session_ = session_after(session_);
    sequence_ = 0;
    snapshot_.echoed_sent = -kForever;
    snapshot_.round_trip = -1;
  }
  return Reject::kRefused;
}

void PeerCore::hear_version(std::uint8_t version, Nanos now) noexcept {
  snapshot_.other_wire = version;
  snapshot_.other_wire_at = now;
}

void PeerCore::count(Reject cause) noexcept {
  ++rejects_[static_cast<std::size_t>(cause)];
  ++(cause == Reject::kNone ? snapshot_.accepted : snapshot_.rejected);
}

DatagramHeader PeerCore::next_header(Nanos now) const noexcept {
  DatagramHeader header{.session = session_, .sequence = sequence_ + 1, .sent = now};
  if (peer_session_ != 0) {
    header.echo_session = peer_session_;
    header.echo_sequence = arrivals_.newest();
    header.echo_sent = snapshot_.peer_sent;
    header.echo_held = std::max<Nanos>(now - snapshot_.received_at, 0);
    header.received_of_100 = static_cast<std::uint32_t>(snapshot_.received_of_100);
  }
  return header;
}

void PeerCore::after_send(Nanos now, bool sent) noexcept {
  if (sent) {
    ++sequence_;
    ++snapshot_.sent;
  } else {
    ++snapshot_.unsendable;
  }
  move_schedule(now);
}

void PeerCore::withhold(Nanos now) noexcept {
  if (!due(now)) return;
  ++snapshot_.withheld;
  move_schedule(now);
}

void PeerCore::move_schedule(Nanos now) noexcept {
  const Nanos late = next_due_ == -kForever ? 0 : now - next_due_;
  next_due_ = now - late % kSendPeriod + kSendPeriod;
}

Nanos PeerCore::wait_time(Nanos now) const noexcept {
  return sequence_ == UINT64_MAX ? kForever : std::max<Nanos>(next_due_ - now, 0);
}

std::uint64_t session_after(std::uint64_t session) noexcept {
  Random random(session);
  std::uint64_t next = 0;
  while (next == 0 || next == session) next = random.bits();
  return next;
}

std::uint64_t random_session_id() {
  std::random_device source;
  std::uint64_t id = 0;
  while (id == 0) id = (std::uint64_t{source()} << 32) | source();
  return id;
}

}  // namespace handrail
