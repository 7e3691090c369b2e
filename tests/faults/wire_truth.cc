#include "tests/faults/wire_truth.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "tests/emulator/tap.h"

namespace handrail::faults {
namespace {

constexpr std::uint8_t kIpv4 = 4, kUdp = 17;

struct Datagram {
  std::uint16_t from = 0, to = 0;  // ports
  std::uint64_t bytes = 0;         // of its payload
  bool state = false;              // a record that carries one
};

std::uint16_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

// Nothing: no UDP over IPv4.
std::optional<Datagram> datagram_of(const std::vector<std::uint8_t>& packet) {
  if (packet.empty() || packet[0] >> 4 != kIpv4) return std::nullopt;
  const std::size_t header = 4 * static_cast<std::size_t>(packet[0] & 15);
  if (packet.size() < header + kUdpHeader || packet[9] != kUdp) return std::nullopt;
  Datagram out;
  out.from = number_at(packet, header);
  out.to = number_at(packet, header + 2);
  out.bytes = number_at(packet, header + 4) - kUdpHeader;
  const std::size_t record = header + kUdpHeader;
  out.state = packet.size() > record && packet[record] == kApplicationData;
  return out;
}

}  // namespace

Result<WireTruth> read_truth(const std::string& folder) {
  WireTruth out;
  std::unordered_map<std::uint64_t, Nanos> sent;
  std::uint64_t newest = 0;
  const Status near = emulator::scan_tap(folder + "/near.pcap", [&](emulator::TapRecord& r) {
    const auto datagram = datagram_of(r.packet);
    if (!datagram || !datagram->state) return;
    if (r.sent && datagram->to == kLinkPort) sent[r.number] = r.at;
    if (r.sent) out.longest = std::max(out.longest, datagram->bytes);
    if (r.sent || datagram->from != kLinkPort) return;
    // A copy that came before its original was the first to tell.
    const bool genuine = r.origin == Origin::kGenuine || r.origin == Origin::kDuplicate;
    if (!genuine || r.number <= newest) return;
    newest = r.number;
    out.to_master.push_back(r.at);
  });
  if (!near) return near;
  newest = 0;
  const Status far = emulator::scan_tap(folder + "/far.pcap", [&](emulator::TapRecord& r) {
    const auto datagram = datagram_of(r.packet);
    if (!datagram) return;
    if (r.sent) out.longest = std::max(out.longest, datagram->state ? datagram->bytes : 0);
    if (r.sent || datagram->to != kLinkPort) return;
    const auto origin = static_cast<std::size_t>(r.origin);
    if (r.origin != Origin::kGenuine) {
      ++out.at_slave.at(origin);
      // A copy that came before its original was the first to tell.
      const bool first = r.origin == Origin::kDuplicate && datagram->state && r.number > newest;
      if (!first) return;
    } else if (!datagram->state) {
      return;
    } else if (r.number <= newest) {
      ++out.overtaken;
      return;
    } else {
      ++out.at_slave.at(origin);
    }
    newest = r.number;
    const auto when = sent.find(r.number);
    out.to_slave.push_back({when == sent.end() ? r.at : when->second, r.at, r.number});
  });
  if (!far) return far;
  return out;
}

}  // namespace handrail::faults
