// Moves datagrams between a transport and a peer.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "server/base/deletable.h"
#include "server/base/time.h"
#include "server/link/frame.h"
#include "server/link/peer.h"
#include "server/link/transport.h"

namespace handrail {

// Call receive() and send() at least once a kSendPeriod, and receive() whenever something waits.
// Real-time safe, one thread at a time. Transport and peer must outlive it.
template <typename Local, typename Remote>
class LinkPump {
 public:
  // With receive() not called for longer than this, what waits is older than it looks.
  static constexpr Nanos kStall = 20 * kMillisecond;

  LinkPump(Transport& transport, LinkPeer<Local, Remote>& peer)
      : transport_(transport), peer_(peer) {}

  // Takes what waits, at most kBatch datagrams. True when the peer has said something new: its
  // newest state, or that another leads it. Who is refused for another's sake is told so.
  // After a stall of our own everything that waits is dropped and counted: the next datagram, a
  // millisecond away, tells its age truly.
  bool receive(Nanos now) noexcept {
    dropping_ = dropping_ || (last_receive_ != -kForever && now - last_receive_ > kStall);
    last_receive_ = now;
    bool changed = false;
    for (int i = 0; i < kBatch; ++i) {
      const auto arrival = transport_.receive(buffer_);
      if (!arrival) {
        dropping_ = false;
        break;
      }
      if (arrival->handled) continue;
      if (dropping_) {
        peer_.count_dropped(Reject::kAfterStall);
      } else if (!arrival->from_peer) {
        peer_.count_dropped(Reject::kSender);
      } else {
        const Reject cause = peer_.on_datagram(std::span(buffer_).first(arrival->size), now);
        if (cause == Reject::kNone) transport_.adopt_sender();
        if (cause == Reject::kVersion) other_version_ = buffer_[kVersionAt];
        changed = changed || cause == Reject::kNone || cause == Reject::kRefused;
        const std::size_t size = peer_.refuse(cause, transport_.peer_name(), now, buffer_);
        if (size != 0) (void)transport_.answer(std::span(buffer_).first(size));
      }
    }
    return changed;
  }

  // Of the wire contract, that the peer said last where it is not ours; 0: it has not. From now on
  // forgotten.
  int take_other_version() noexcept { return std::exchange(other_version_, 0); }

  // Sends `state` if a datagram is due, until `sent_until`: a loop that stands still falls silent,
  // and the other side's ladder does the rest.
  void send(Nanos now, const Local& state, Nanos sent_until = kForever) noexcept {
    if (now > sent_until && kept(Check::kStaleSend)) return peer_.withhold(now);
    const std::size_t size = peer_.poll(now, state, buffer_);
    if (size != 0) (void)transport_.send(std::span(buffer_).first(size));
  }

 private:
  static constexpr int kBatch = 256;

  Transport& transport_;
  LinkPeer<Local, Remote>& peer_;
  std::array<std::uint8_t, kMaxDatagram + 1> buffer_{};  // one more shows what is too long
  Nanos last_receive_ = -kForever;
  bool dropping_ = false;
  int other_version_ = 0;
};

}  // namespace handrail
