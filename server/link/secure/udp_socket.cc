#include "server/link/secure/udp_socket.h"

#include <boost/asio/buffer.hpp>

#include <algorithm>
#include <utility>

#include "server/keys/own_socket.h"

namespace handrail {
namespace {

namespace asio = boost::asio;
namespace ip = boost::asio::ip;
using boost::system::error_code;
using Endpoint = ip::udp::endpoint;

}  // namespace

Address address_of(const Endpoint& endpoint) noexcept {
  Address out;
  out.port = endpoint.port();
  const ip::address address = endpoint.address();
  if (address.is_v6()) {
    out.ip = address.to_v6().to_bytes();
    out.scope = static_cast<std::uint32_t>(address.to_v6().scope_id());
    return out;
  }
  out.ip[10] = out.ip[11] = 0xff;
  const auto bytes = address.to_v4().to_bytes();
  std::copy(bytes.begin(), bytes.end(), out.ip.begin() + 12);
  return out;
}

Status UdpSocket::open(const std::string& address, std::uint16_t port) {
  close();
  if (Status opened = open_own(socket_, {"link", "set link_port to another", address, port});
      !opened) {
    return opened;
  }
  error_code error;
  const Endpoint bound = socket_.local_endpoint(error);
  v6_ = bound.address().is_v6();
  port_ = bound.port();
  return error ? Status::error("link port: " + error.message()) : Status::ok();
}

void UdpSocket::on_readable(std::function<void()> readable) {
  readable_ = std::move(readable);
  wait_readable();
}

void UdpSocket::wait_readable() {
  socket_.async_wait(asio::socket_base::wait_read, [this](const error_code& error) {
    if (error) return;
    readable_();
    wait_readable();
  });
}

void UdpSocket::close() noexcept {
  error_code ignored;
  socket_.close(ignored);
  port_ = 0;
}

std::optional<DatagramSocket::Arrival> UdpSocket::receive(std::span<std::uint8_t> buffer) noexcept {
  // An error that an earlier datagram has left, such as a port that nobody listens at, is not one
  // of what waits behind it.
  for (int errors = 0; errors < 8; ++errors) {
    error_code error;
    Endpoint from;
    const std::size_t size =
        socket_.receive_from(asio::buffer(buffer.data(), buffer.size()), from, 0, error);
    if (!error) return Arrival{size, address_of(from)};
    if (error == asio::error::would_block || error == asio::error::bad_descriptor) break;
  }
  return std::nullopt;
}

bool UdpSocket::send(std::span<const std::uint8_t> bytes, const Address& to) noexcept {
  const ip::address_v6 v6(to.ip, to.scope);
  error_code error;
  const Endpoint endpoint =
      v6_ ? Endpoint(v6, to.port)
          : Endpoint(v6.is_v4_mapped() ? ip::make_address_v4(ip::v4_mapped, v6) : ip::address_v4(),
                     to.port);
  if (!v6_ && !v6.is_v4_mapped()) return false;
  socket_.send_to(asio::buffer(bytes.data(), bytes.size()), endpoint, 0, error);
  return !error;
}

}  // namespace handrail
