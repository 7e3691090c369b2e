// A computer and a port of it, as a person types them.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/status.h"

namespace handrail {

// "HOST", "HOST:PORT", "[IPv6]:PORT" or an IPv6 address alone.
struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};
// The error says what was expected. `port`: where none is named. `least`: the lowest that may be
// named; 0, any that is free, is for who listens.
Result<HostPort> parse_host(const std::string& text, std::uint16_t port, unsigned least = 1);

}  // namespace handrail
