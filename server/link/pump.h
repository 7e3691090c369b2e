// Moves datagrams between a transport and a peer.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/base/deletable.h"
#include "server/base/time.h"
#include "server/link/peer.h"
#include "server/link/transport.h"
#include "server/packets/packet_tap.h"

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

  // What the peer's address sends and what is sent to it is left in `tap` too; null: no more. It
  // outlives the pump.
  void keep(PacketTap* tap) noexcept { tap_ = tap; }

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
      // What strangers send is only counted: they could fill a recording.
      if (tap_ != nullptr && arrival->from_peer)
        tap_->keep(PacketWay::kLinkIn, now, std::span(buffer_).first(arrival->size));
      if (dropping_) {
        peer_.count_dropped(Reject::kAfterStall);
      } else if (!arrival->from_peer) {
        peer_.count_dropped(Reject::kSender);
      } else {
        const Reject cause = peer_.on_datagram(std::span(buffer_).first(arrival->size), now);
        if (cause == Reject::kNone) transport_.adopt_sender();
        changed = changed || cause == Reject::kNone || cause == Reject::kRefused;
        const std::size_t size = peer_.refuse(cause, transport_.peer_name(), now, buffer_);
        if (size != 0) (void)transport_.answer(std::span(buffer_).first(size));
      }
    }
    return changed;
  }

  // Sends `state` if a datagram is due, until `sent_until`: a loop that stands still falls silent,
  // and the other side's ladder does the rest.
  void send(Nanos now, const Local& state, Nanos sent_until = kForever) noexcept {
    if (now > sent_until && kept(Check::kStaleSend)) return peer_.withhold(now);
    const std::size_t size = peer_.poll(now, state, buffer_);
    if (size == 0) return;
    const std::span<const std::uint8_t> datagram = std::span(buffer_).first(size);
    (void)transport_.send(datagram);
    if (tap_ != nullptr) tap_->keep(PacketWay::kLinkOut, now, datagram);
  }

 private:
  static constexpr int kBatch = 256;

  Transport& transport_;
  LinkPeer<Local, Remote>& peer_;
  std::array<std::uint8_t, kMaxDatagram + 1> buffer_{};  // one more shows what is too long
  Nanos last_receive_ = -kForever;
  bool dropping_ = false;
  PacketTap* tap_ = nullptr;
};

}  // namespace handrail
