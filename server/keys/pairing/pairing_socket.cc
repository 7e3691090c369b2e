#include "server/keys/pairing/pairing_socket.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>

#include "server/base/clock.h"
#include "server/keys/own_socket.h"

namespace handrail {
namespace {

namespace asio = boost::asio;
namespace ip = boost::asio::ip;
using ip::tcp;

// How long the other side may take to read why it is refused, before the connection is cut.
constexpr Nanos kParting = kSecond;

std::string place_text(const tcp::endpoint& at) {
  ip::address address = at.address();
  if (address.is_v6() && address.to_v6().is_v4_mapped()) {
    address = ip::make_address_v4(ip::v4_mapped, address.to_v6());
  }
  const std::string text = address.to_string();
  return (address.is_v6() ? "[" + text + "]" : text) + ":" + std::to_string(at.port());
}

}  // namespace

Status PairingSocket::listen(const HostPort& where) {
  if (Status opened = open_own(
          acceptor_, {"pairing", "name another as --listen any:PORT", where.host, where.port});
      !opened) {
    return opened;
  }
  Error error;
  port_ = acceptor_.local_endpoint(error).port();
  return error ? Status::error("pairing port: " + error.message()) : Status::ok();
}

PairingSocket::Error PairingSocket::wait(
    Nanos until, const std::function<void(std::function<void(Error)>)>& start) {
  std::optional<Error> ended;
  start([&ended](Error error) { ended = error; });
  io_.restart();
  const Nanos left = until - monotonic_now();
  if (left > 0) io_.run_for(std::chrono::nanoseconds(left));
  if (ended) return *ended;
  Error ignored;
  socket_.close(ignored);
  if (acceptor_.is_open()) acceptor_.cancel(ignored);
  io_.restart();
  io_.run();  // what was given up still speaks of this function's variables
  return asio::error::timed_out;
}

bool PairingSocket::exchange(Pairing& pairing, Nanos until) {
  std::array<std::uint8_t, 4096> buffer;
  for (;;) {
    const auto bytes = pairing.give();
    Error error;
    if (!bytes.empty()) {
      error = wait(until, [&](auto done) {
        asio::async_write(socket_, asio::buffer(bytes), [done](Error e, std::size_t) { done(e); });
      });
    }
    if (pairing.over()) return true;
    std::size_t size = 0;
    if (!error) {
      error = wait(until, [&](auto done) {
        socket_.async_read_some(asio::buffer(buffer), [&size, done](Error e, std::size_t n) {
          size = n;
          done(e);
        });
      });
    }
    if (error == asio::error::timed_out) return false;
    if (error) {
      pairing.end();
    } else {
      pairing.take(std::span(buffer).first(size));
    }
  }
}

void PairingSocket::part() {
  Error error;
  socket_.shutdown(tcp::socket::shutdown_send, error);
  const Nanos until = monotonic_now() + kParting;
  std::array<std::uint8_t, 4096> buffer;
  // A connection that is closed with bytes unread takes our last words back (RFC 1122, 4.2.2.13).
  for (int i = 0; i < 16 && !error; ++i) {
    error = wait(until, [&](auto done) {
      socket_.async_read_some(asio::buffer(buffer), [done](Error e, std::size_t) { done(e); });
    });
  }
  socket_.close(error);
}

Result<Trusted> PairingSocket::serve(
    const std::function<Result<std::unique_ptr<Pairing>>(const std::string& caller)>& make,
    Nanos time, const std::function<void(const std::string&)>& stranger) {
  const Nanos end = monotonic_now() + time;
  // Who waits behind the last caller is told so at once.
  const std::shared_ptr<void> closed(nullptr, [this](void*) {
    Error ignored;
    acceptor_.close(ignored);
  });
  for (int strangers = 0; strangers < kMostStrangers; ++strangers) {
    socket_ = tcp::socket(io_);
    const Error error = wait(end, [&](auto done) { acceptor_.async_accept(socket_, done); });
    if (error == asio::error::timed_out) {
      return Status::error("nobody has paired within " + std::to_string(time / kSecond) +
                           " s: the code is good no more; run this again for another");
    }
    Error unknown;
    const std::string caller = place_text(socket_.remote_endpoint(unknown));
    if (error || unknown) continue;
    auto pairing = make(caller);
    if (!pairing) return pairing.status();
    const bool over = exchange(**pairing, std::min(end, monotonic_now() + kPatience));
    part();
    if (over && (*pairing)->result()) return *(*pairing)->other();
    const std::string what =
        caller + ": " +
        (over ? (*pairing)->result().message()
              : "did not go on within " + std::to_string(kPatience / kSecond) + " s");
    if ((*pairing)->guessed()) return Status::error(what + (over ? "" : ", and may have guessed"));
    stranger(what);
  }
  return Status::error(std::to_string(kMostStrangers) +
                       " callers that did not pair: somebody keeps this port busy");
}

Result<Trusted> PairingSocket::call(
    const HostPort& where,
    const std::function<Result<std::unique_ptr<Pairing>>(const std::string& at)>& make) {
  const bool v6 = where.host.find(':') != std::string::npos;
  const std::string named =
      (v6 ? "[" + where.host + "]" : where.host) + ":" + std::to_string(where.port);
  const Nanos end = monotonic_now() + 4 * kPatience;  // there may be some before us
  tcp::resolver resolver(io_);
  Error error;
  const auto found = resolver.resolve(where.host, std::to_string(where.port),
                                      tcp::resolver::numeric_service, error);
  if (error || found.empty()) {
    return Status::error("'" + where.host + "' has no address: " + error.message());
  }
  for (const auto& entry : found) {
    socket_ = tcp::socket(io_);
    error = wait(std::min(end, monotonic_now() + kPatience),
                 [&](auto done) { socket_.async_connect(entry.endpoint(), done); });
    if (!error) break;
  }
  if (error) {
    return Status::error("nobody pairs at " + named + ": " + error.message() +
                         ": does `handrail keys pair` wait there, and does TCP port " +
                         std::to_string(where.port) + " pass every firewall on the way?");
  }
  auto pairing = make(place_text(socket_.remote_endpoint(error)));
  if (!pairing) return pairing.status();
  const bool over = exchange(**pairing, end);
  part();
  if (!over) {
    return Status::error(named + " did not go on within " +
                         std::to_string(4 * kPatience / kSecond) +
                         " s: is that `handrail keys pair`, or does it speak with another?");
  }
  if (!(*pairing)->result()) return Status::error(named + ": " + (*pairing)->result().message());
  return *(*pairing)->other();
}

}  // namespace handrail
