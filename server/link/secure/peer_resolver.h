// From a name to addresses, without waiting.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/base/status.h"
#include "server/keys/host_port.h"
#include "server/link/secure/address.h"

namespace handrail {

class PeerResolver {
 public:
  explicit PeerResolver(boost::asio::io_context& io) : resolver_(io) {}

  // Calls `found` once in the io_context's thread: all addresses of the host, IPv6 and IPv4 in turn
  // as the system orders them, or why there is none. One question at a time: false while one is
  // open.
  bool ask(const HostPort& where, std::function<void(Result<std::vector<Address>>)> found);

 private:
  boost::asio::ip::udp::resolver resolver_;
  bool asking_ = false;
};

}  // namespace handrail
