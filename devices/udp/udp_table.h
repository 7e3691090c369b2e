// Who on this computer speaks with whom over UDP, as the kernel tells everybody.
#pragma once

#include <cstdint>
#include <string>

namespace handrail {

// Of IPv4, in proc(5).
inline constexpr char kUdpTable[] = "/proc/net/udp";

// Whether a socket of any program of this computer is connected to `address`, IPv4 in text, and
// `port`; false where the table cannot be read.
bool udp_speaks_with(const std::string& table, const std::string& address, std::uint16_t port);

}  // namespace handrail
