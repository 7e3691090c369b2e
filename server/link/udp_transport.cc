#include "server/link/udp_transport.h"

namespace handrail {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// `role` such as "link address", for the error's text.
Result<asio::ip::address> loopback_address(const std::string& role, const std::string& text) {
  error_code error;
  const asio::ip::address address = asio::ip::make_address(text, error);
  if (error) {
    return Status::error(role + " '" + text + "': expected an IP address, 127.0.0.1 or ::1");
  }
  if (!address.is_loopback()) {
    return Status::error(role + " " + text +
                         ": the link is plain, neither encrypted nor authenticated, and so runs on "
                         "this computer only: expected a loopback address such as 127.0.0.1");
  }
  return address;
}

Status bind_error(const UdpTransportOptions& options, const error_code& error) {
  const std::string port = "link port " + std::to_string(options.port) + " on " + options.address;
  if (error == asio::error::address_in_use) {
    return Status::error(port + " is in use, likely by a program like this one that still runs: " +
                         "end it, or set link_port to another");
  }
  return Status::error(port + ": " + error.message());
}

}  // namespace

Status UdpTransport::open(const UdpTransportOptions& options) {
  close();
  const auto own = loopback_address("link address", options.address);
  if (!own) return own.status();
  peer_fixed_ = !options.peer_address.empty();
  if (peer_fixed_) {
    const auto peer = loopback_address("peer address", options.peer_address);
    if (!peer) return peer.status();
    if (options.peer_port == 0) return Status::error("peer port 0: expected 1 to 65535");
    if (own->is_v4() != peer->is_v4()) {
      return Status::error("link address " + options.address + " and peer address " +
                           options.peer_address + ": expected both IPv4 or both IPv6");
    }
    peer_ = Endpoint(*peer, options.peer_port);
    peer_known_ = true;
  }
  const Endpoint local(*own, options.port);
  error_code error;
  socket_.open(local.protocol(), error);
  if (!error) socket_.non_blocking(true, error);
  if (!error) socket_.bind(local, error);
  const Endpoint bound = error ? local : socket_.local_endpoint(error);
  if (error) {
    close();
    return bind_error(options, error);
  }
  port_ = bound.port();
  return Status::ok();
}

void UdpTransport::on_readable(std::function<void()> readable) {
  readable_ = std::move(readable);
  wait_readable();
}

void UdpTransport::wait_readable() {
  socket_.async_wait(asio::socket_base::wait_read, [this](const error_code& error) {
    if (error) return;
    readable_();
    wait_readable();
  });
}

void UdpTransport::close() noexcept {
  error_code ignored;
  socket_.close(ignored);
  port_ = 0;
  peer_known_ = peer_fixed_ = false;
}

std::optional<Transport::Arrival> UdpTransport::receive(std::span<std::uint8_t> buffer) noexcept {
  error_code error;
  const std::size_t size =
      socket_.receive_from(asio::buffer(buffer.data(), buffer.size()), sender_, 0, error);
  if (error) return std::nullopt;
  const bool from_peer = peer_fixed_ ? sender_ == peer_ : sender_.address().is_loopback();
  return Arrival{size, from_peer};
}

void UdpTransport::adopt_sender() noexcept {
  if (peer_fixed_) return;
  peer_ = sender_;
  peer_known_ = true;
}

bool UdpTransport::send(std::span<const std::uint8_t> bytes) noexcept {
  return peer_known_ && send_to(bytes, peer_);
}

bool UdpTransport::answer(std::span<const std::uint8_t> bytes) noexcept {
  return sender_.address().is_loopback() && send_to(bytes, sender_);
}

bool UdpTransport::send_to(std::span<const std::uint8_t> bytes, const Endpoint& to) noexcept {
  error_code error;
  socket_.send_to(asio::buffer(bytes.data(), bytes.size()), to, 0, error);
  return !error;
}

}  // namespace handrail
