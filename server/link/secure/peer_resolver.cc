#include "server/link/secure/peer_resolver.h"

#include <boost/asio/ip/address_v6.hpp>

#include <charconv>
#include <utility>

#include "server/link/secure/udp_socket.h"

namespace handrail {

Result<HostPort> parse_host(const std::string& text, std::uint16_t port) {
  std::string expected = "'";
  expected.append(text, 0, 80)
      .append(
          "': expected a name or an address, and a port of 1 to 65535 after a colon if it is not ")
      .append(std::to_string(port))
      .append(": cell.example.org, 192.0.2.7:47002, [2001:db8::7]:47002");
  const Status wrong = Status::error(expected);
  std::string host = text, number;
  const std::size_t colon = text.rfind(':');
  const bool bracket = !text.empty() && text.front() == '[';
  if (bracket) {
    const std::size_t end = text.find(']');
    if (end == std::string::npos) return wrong;
    host = text.substr(1, end - 1);
    if (end + 1 < text.size()) {
      if (text[end + 1] != ':') return wrong;
      number = text.substr(end + 2);
      if (number.empty()) return wrong;
    }
  } else if (colon != std::string::npos && text.find(':') == colon) {
    host = text.substr(0, colon);
    number = text.substr(colon + 1);
    if (number.empty()) return wrong;
  }
  unsigned value = port;
  if (!number.empty()) {
    const char* end = number.data() + number.size();
    const auto [at, error] = std::from_chars(number.data(), end, value);
    if (error != std::errc() || at != end || value == 0 || value > 65535) return wrong;
  }
  if (host.empty() || host.size() > 253 || host.find_first_of(" \t\r\n/\\") != std::string::npos) {
    return wrong;
  }
  return HostPort{host, static_cast<std::uint16_t>(value)};
}

Result<boost::asio::ip::address> own_ip(const std::string& text, bool v6) {
  namespace ip = boost::asio::ip;
  if (text == "any") {
    return v6 ? ip::address(ip::address_v6::any()) : ip::address(ip::address_v4::any());
  }
  boost::system::error_code error;
  const ip::address address = ip::make_address(text, error);
  if (!error) return address;
  std::string expected = "'";
  expected.append(text).append(
      "': expected any, or an address of this computer, IPv4 such as 192.0.2.7 or IPv6 such as "
      "2001:db8::7");
  return Status::error(expected);
}

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
