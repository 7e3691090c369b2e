#include "server/link/secure/address.h"

#include <arpa/inet.h>

#include <algorithm>

namespace handrail {

namespace {

constexpr std::array<std::uint8_t, 12> kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

}  // namespace

bool is_v4(const Address& address) noexcept {
  return std::equal(kMapped.begin(), kMapped.end(), address.ip.begin());
}

std::string address_text(const Address& address) {
  const bool v4 = is_v4(address);
  std::array<char, INET6_ADDRSTRLEN> text{};
  ::inet_ntop(v4 ? AF_INET : AF_INET6, address.ip.data() + (v4 ? kMapped.size() : 0), text.data(),
              text.size());
  std::string out = v4 ? "" : "[";
  out.append(text.data());
  if (address.scope != 0) out.append("%").append(std::to_string(address.scope));
  if (!v4) out.append("]");
  return out.append(":").append(std::to_string(address.port));
}

}  // namespace handrail
