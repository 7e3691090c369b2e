#include "server/link/secure/peer_resolver.h"

#include <utility>

#include "server/link/secure/udp_socket.h"

namespace handrail {

bool PeerResolver::ask(const HostPort& where,
                       std::function<void(Result<std::vector<Address>>)> found) {
  if (asking_) return false;
  asking_ = true;
  resolver_.async_resolve(
      where.host, std::to_string(where.port), boost::asio::ip::resolver_query_base::numeric_service,
      [this, host = where.host, found = std::move(found)](const boost::system::error_code& error,
                                                          const auto& results) {
        asking_ = false;
        if (error == boost::asio::error::operation_aborted) return;
        std::vector<Address> addresses;
        for (const auto& entry : results) addresses.push_back(address_of(entry.endpoint()));
        if (error || addresses.empty()) {
          std::string why = "'";
          why.append(host).append("' has no address: ");
          found(Status::error(why.append(error ? error.message() : "the name is not known")));
        } else {
          found(std::move(addresses));
        }
      });
  return true;
}

}  // namespace handrail
