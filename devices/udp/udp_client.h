// A UDP socket that talks to one peer: what the network drivers of this folder share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "server/base/status.h"
#include "server/base/time.h"
#include "server/packets/packet_tap.h"

namespace handrail {

// Datagrams from anyone but the peer, another address or another port, never arrive. One thread.
class UdpClient {
 public:
  UdpClient();
  ~UdpClient();

  // Opens a socket on any free port toward `address`, an IPv4 or IPv6 address in text, replacing
  // one already open. `receive_buffer` [bytes] is what the system may queue (it rounds up). The
  // error names address and cause.
  Status open(const std::string& address, std::uint16_t port, int receive_buffer);
  // Sends one datagram. False when closed or the system refused it, which is then one lost
  // datagram. Never waits. Real-time safe.
  bool send(std::span<const std::uint8_t> bytes) noexcept;
  // Takes one datagram and returns its size, or nothing when none waits. One that is longer than
  // `buffer` is cut to it, so give room for one byte more than the longest. Real-time safe.
  std::optional<std::size_t> receive(std::span<std::uint8_t> buffer) noexcept;
  // Sleeps until a datagram waits or `timeout` has passed; also when closed.
  void wait(Nanos timeout) noexcept;
  void close() noexcept;
  // From now on what comes and what is sent is left in `tap` too, as of those ways; null: no more.
  // It outlives this or the next call. The client's thread writes to it.
  void keep(PacketTap* tap, PacketWay in, PacketWay out) noexcept;

 private:
  void drop_waiting() noexcept;

  struct Socket;
  std::unique_ptr<Socket> socket_;
  PacketTap* tap_ = nullptr;
  PacketWay in_ = PacketWay::kRobotIn, out_ = PacketWay::kRobotOut;
};

}  // namespace handrail
