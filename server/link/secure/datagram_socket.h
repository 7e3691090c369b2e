// What carries datagrams to and from addresses: a UDP socket, or a network made up by a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "server/link/secure/address.h"

namespace handrail {

// Never waits. One thread at a time.
class DatagramSocket {
 public:
  struct Arrival {
    std::size_t size = 0;  // up to the buffer's size; a longer datagram is cut
    Address from;
  };

  virtual ~DatagramSocket() = default;
  // Takes the datagram that has waited longest; nothing when none waits. Real-time safe.
  virtual std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept = 0;
  // False: it was not sent, which is one lost datagram. Real-time safe.
  virtual bool send(std::span<const std::uint8_t> bytes, const Address& to) noexcept = 0;
};

}  // namespace handrail
