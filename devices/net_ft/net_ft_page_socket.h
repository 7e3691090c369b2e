// A sensor's page over HTTP.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// The body of http://ADDRESS:PORT/netftapi2.xml, an IPv4 address in text, within `patience`. The
// error names the address and the cause.
Result<std::string> fetch_net_ft_page(const std::string& address, std::uint16_t port,
                                      Nanos patience);

}  // namespace handrail
