#include "tests/faults/forged.h"

#include <algorithm>

#include "tests/emulator/tap.h"
#include "tests/faults/wire_truth.h"

namespace handrail::faults {
namespace {

// Offsets in a datagram of DTLS 1.2: record header 13, handshake header 12, version 2, random 32.
constexpr std::size_t kRecordHeader = 13, kSessionId = 13 + 12 + 2 + 32;
constexpr std::uint8_t kHandshake = 22, kClientHello = 1;

std::uint64_t big_endian(const std::uint8_t* at, std::size_t size) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < size; ++i) out = out << 8 | at[i];
  return out;
}

}  // namespace

Result<SeenSession> see_session(const std::string& path) {
  SeenSession out;
  const Status read = emulator::scan_tap(path, [&out](emulator::TapRecord& r) {
    if (r.sent || r.origin != Origin::kGenuine) return;
    const auto layout = emulator::layout_of(r.packet);
    if (!layout || r.packet.size() < 28 || r.packet[0] >> 4 != 4) return;
    const auto to = emulator::destination_of(r.packet, *layout);
    if (to.port != kLinkPort) return;
    const Bytes payload(r.packet.begin() + 20 + kUdpHeader, r.packet.end());
    if (payload.size() <= kSessionId) return;
    if (payload[0] == kApplicationData) {
      out.master = emulator::source_of(r.packet, *layout);
      out.slave = to;
      out.record = big_endian(payload.data() + 3, 8);
    } else if (payload[0] == kHandshake && payload[kRecordHeader] == kClientHello) {
      const std::size_t cookie = kSessionId + 1 + payload[kSessionId];
      const bool has_cookie = cookie < payload.size() && payload[cookie] != 0;
      (has_cookie ? out.hello : out.first_hello) = payload;
    }
  });
  if (!read) return read;
  if (out.record == 0) return Status::error(path + ": has no session");
  if (out.hello.empty() || out.first_hello.empty()) return Status::error(path + ": has no hello");
  return out;
}

Bytes record_of(std::uint8_t type, std::uint64_t epoch_and_sequence, const Bytes& body) {
  Bytes out = {type, 0xfe, 0xfd};
  for (int i = 7; i >= 0; --i)
    out.push_back(static_cast<std::uint8_t>(epoch_and_sequence >> (8 * i)));
  out.push_back(static_cast<std::uint8_t>(body.size() >> 8));
  out.push_back(static_cast<std::uint8_t>(body.size()));
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

Bytes random_bytes(Random& random, std::size_t size) {
  Bytes out(size);
  std::generate(out.begin(), out.end(),
                [&random] { return static_cast<std::uint8_t>(random.bits() >> 32); });
  return out;
}

Status write_packets(const std::string& path, int count, Bytes (*next)(void*, int), void* of) {
  auto tap = emulator::Tap::open(path);
  if (!tap) return tap.status();
  for (int i = 0; i < count; ++i) tap->delivered(next(of, i), 0, Origin::kGenuine, 0);
  return tap->close();
}

}  // namespace handrail::faults
