// What spacenavd says to its clients, from bytes. No socket.
//
// Source: FreeSpacenav/spacenavd, src/proto_unix.c and proto.h; libspnav, src/spnav.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace handrail {

// A client that knows protocol 1 says so first: this word and the protocol's number. The daemon
// answers with the same word and the number that it takes. One that knows protocol 0 only takes the
// word for a sensitivity that is not a number, and answers nothing.
inline constexpr std::uint32_t kSpnavProtocol = 0x7faa5500;
inline constexpr std::size_t kSpnavRecord = 32;  // eight int32 in the computer's byte order [bytes]

// The newest of what it said.
struct SpnavState {
  std::array<std::int32_t, 6> counts{};  // x y z rx ry rz, as the daemon names them
  std::uint32_t buttons = 0;             // bit n = button n, the first 32
  bool unplugged = false;                // a device was taken away, and nothing came since
  std::uint64_t motions = 0;             // records of motion so far
};

// Takes the stream apart, however it is cut. Real-time safe.
class SpnavStream {
 public:
  // False where the bytes cannot be spacenavd's: what comes after means nothing until reset().
  bool take(std::span<const std::uint8_t> bytes) noexcept;
  void reset() noexcept { *this = SpnavStream(); }

  const SpnavState& state() const noexcept { return state_; }
  // 0 until the daemon has told another.
  int protocol() const noexcept { return protocol_; }

 private:
  bool take_word() noexcept;
  bool take_record() noexcept;

  std::array<std::uint8_t, kSpnavRecord> part_{};
  std::size_t length_ = 0;  // of part_
  int protocol_ = 0;
  bool bad_ = false;
  SpnavState state_;
};

}  // namespace handrail
