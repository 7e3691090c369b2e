#include "server/lab/cell/virtual_link.h"

#include <algorithm>

#include "server/link/codec.h"

namespace handrail {

VirtualLink::VirtualLink(std::uint64_t seed)
    : to_slave_(seed, {.longest = kMaxDatagram}), to_master_(~seed, {.longest = kMaxDatagram}) {}

void VirtualLink::at(Nanos now) noexcept {
  now_ = now;
  to_slave_.advance(now);
  to_master_.advance(now);
}

Nanos VirtualLink::next_due() const noexcept {
  return std::min(to_slave_.next_due(), to_master_.next_due());
}

std::optional<Transport::Arrival> VirtualLink::End::receive(
    std::span<std::uint8_t> buffer) noexcept {
  const std::size_t size = in_.receive(buffer, now_);
  if (size == 0) return std::nullopt;
  return Arrival{size, true};
}

bool VirtualLink::End::send(std::span<const std::uint8_t> bytes) noexcept {
  out_.send(bytes, now_);
  return true;
}

}  // namespace handrail
