// What carries datagrams to the one peer and back: sockets, or a network made up by a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace handrail {

// Never waits. One thread at a time.
class Transport {
 public:
  struct Arrival {
    std::size_t size = 0;    // up to the buffer's size; a longer datagram is cut
    bool from_peer = false;  // false: from an address the peer cannot have; drop it
  };

  virtual ~Transport() = default;
  // Takes the datagram that has waited longest; nothing when none waits. Real-time safe.
  virtual std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept = 0;
  // Where the peer is not given, it is henceforth where the last received datagram came from. Call
  // for accepted datagrams only. Real-time safe.
  virtual void adopt_sender() noexcept = 0;
  // False when the datagram was not sent, which is one lost datagram, or when no peer is known yet.
  // Real-time safe.
  virtual bool send(std::span<const std::uint8_t> bytes) noexcept = 0;
  // To where the last received datagram came from, peer or not. Real-time safe.
  virtual bool answer(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Of the peer; 0: not known, or it has none. Real-time safe.
  virtual std::uint16_t peer_port() const noexcept = 0;
};

}  // namespace handrail
