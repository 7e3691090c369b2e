#include "server/link/secure/address.h"

#include <boost/asio/ip/address.hpp>

namespace handrail {

std::string address_text(const Address& address) {
  namespace ip = boost::asio::ip;
  const ip::address_v6 v6(address.ip, address.scope);
  std::string out;
  if (v6.is_v4_mapped()) {
    out = ip::make_address_v4(ip::v4_mapped, v6).to_string();
  } else {
    out.append("[").append(v6.to_string()).append("]");
  }
  out += ':';
  out += std::to_string(address.port);
  return out;
}

}  // namespace handrail
