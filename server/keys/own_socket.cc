#include "server/keys/own_socket.h"

#include <boost/asio/error.hpp>

namespace handrail {

namespace ip = boost::asio::ip;

Result<ip::address> own_ip(const std::string& text, bool v6) {
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

Status own_port_error(const OwnPort& own, const boost::system::error_code& error) {
  const std::string place =
      own.purpose + " port " + std::to_string(own.port) + " on " + own.address;
  if (error == boost::asio::error::address_in_use) {
    return Status::error(place + " is in use, likely by " + own.holder +
                         " that still runs: end it, or " + own.setting);
  }
  if (error == boost::system::errc::address_not_available) {
    return Status::error(place +
                         ": this computer has no such address: expected any, or one that "
                         "`ip address` shows");
  }
  return Status::error(place + ": " + error.message());
}

}  // namespace handrail
