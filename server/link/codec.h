// State to bytes and back. The wire contract is proto/WIRE.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "server/base/time.h"
#include "server/link/refusal.h"
#include "server/link/reject.h"
#include "server/model/link_state.h"

namespace handrail {

inline constexpr std::uint8_t kWireVersion = 12;

// Largest datagram: the longest is 578 bytes, a slave's with the longest name of a scene. With all
// that the encrypted link puts around it, it fits twice into the 1280 of every IPv6 path (WIRE.md).
inline constexpr std::size_t kMaxDatagram = 578;

// What every datagram says about itself and about the newest one accepted from its receiver. Times
// are on the sender's monotonic clock, but echo_sent, which is the receiver's own given back: no
// clock synchronisation is needed.
struct DatagramHeader {
  std::uint64_t session = 0;   // sender's incarnation, never 0 on the wire
  std::uint64_t sequence = 0;  // from 1, rising
  Nanos sent = 0;
  std::uint64_t echo_session = 0;  // 0: nothing accepted yet, and the other echoes are 0 too
  std::uint64_t echo_sequence = 0;
  Nanos echo_sent = 0;
  Nanos echo_held = 0;                // from acceptance to this send, >= 0
  std::uint32_t received_of_100 = 0;  // of the receiver's last 100 datagrams, 0 to 100

  friend bool operator==(const DatagramHeader&, const DatagramHeader&) = default;
};

// Encodes and decodes datagrams in messages it reuses: no allocation after construction, but for a
// payload that holds unknown fields or too many elements, which is then refused. The checksum finds
// accidents; it does NOT authenticate. One thread at a time.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(Codec&&) noexcept;
  Codec& operator=(Codec&&) noexcept;

  // Writes one datagram and returns its size; 0 when check(state) or the header refuses it or `out`
  // is too small (kMaxDatagram always suffices), with the reason in `cause`. Real-time safe.
  std::size_t encode(const DatagramHeader& header, const MasterState& state,
                     std::span<std::uint8_t> out, Reject& cause) noexcept;
  std::size_t encode(const DatagramHeader& header, const SlaveState& state,
                     std::span<std::uint8_t> out, Reject& cause) noexcept;

  // As above; 0 when it is not sound.
  std::size_t encode(const Refusal& refusal, std::span<std::uint8_t> out) noexcept;

  // Reads one datagram; unless kNone is returned, `header` and `state` hold nothing of use.
  // Quaternions come out of unit length to rounding. Real-time safe.
  Reject decode(std::span<const std::uint8_t> bytes, DatagramHeader& header,
                MasterState& state) noexcept;
  Reject decode(std::span<const std::uint8_t> bytes, DatagramHeader& header,
                SlaveState& state) noexcept;
  Reject decode(std::span<const std::uint8_t> bytes, Refusal& refusal) noexcept;

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

}  // namespace handrail
