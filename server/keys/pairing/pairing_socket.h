// A pairing over TCP: one end listens, the other calls.
#pragma once

#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/base/status.h"
#include "server/base/time.h"
#include "server/keys/host_port.h"
#include "server/keys/pairing/pairing.h"

namespace handrail {

// Waits for what it does, never beyond the time it is told. IPv4 and IPv6. One thread at a time.
class PairingSocket {
 public:
  // A caller that has not paired by then is let go: others may wait behind it. An exchange takes
  // three ways there and back and 20 ms of computing, so a second over the slowest of networks.
  static constexpr Nanos kPatience = 5 * kSecond;
  // Strangers that guess nothing, after which somebody only keeps us busy. Chosen.
  static constexpr int kMostStrangers = 50;

  // Listens at `where`: a host of "any", for every interface, or an address of this computer; port
  // 0 is any free one. The error names the place and what was expected.
  Status listen(const HostPort& where);
  // The port it listens at.
  std::uint16_t port() const noexcept { return port_; }

  // Serves one caller after the other, for `time` in all: until one has paired or has guessed at
  // the code, as `make` begins it for each, and who is told of each in words. A caller that does
  // neither is told to `stranger`, and the next is heard.
  Result<Trusted> serve(
      const std::function<Result<std::unique_ptr<Pairing>>(const std::string& caller)>& make,
      Nanos time, const std::function<void(const std::string&)>& stranger);

  // Calls the first of `where`'s addresses that answers, and pairs with it as `make` begins it.
  Result<Trusted> call(
      const HostPort& where,
      const std::function<Result<std::unique_ptr<Pairing>>(const std::string& at)>& make);

 private:
  using Error = boost::system::error_code;
  // Starts something that ends by calling what it is given, and waits. timed_out: it was given up.
  Error wait(Nanos until, const std::function<void(std::function<void(Error)>)>& start);
  // Until it is over. False: `until` came first.
  bool exchange(Pairing& pairing, Nanos until);
  void part();  // lets the other side read our last words

  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_{io_};
  boost::asio::ip::tcp::socket socket_{io_};
  std::uint16_t port_ = 0;
};

}  // namespace handrail
