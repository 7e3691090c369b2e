#include "devices/udp/udp_client.h"

#include <poll.h>

#include <algorithm>
#include <utility>

#include <boost/asio.hpp>

#include "server/base/clock.h"

namespace handrail {

namespace asio = boost::asio;

struct UdpClient::Socket {
  asio::io_context io{1};
  asio::ip::udp::socket udp{io};
};

UdpClient::UdpClient() : socket_(std::make_unique<Socket>()) {}
UdpClient::~UdpClient() = default;

Status UdpClient::open(const std::string& address, std::uint16_t port, int receive_buffer) {
  close();
  boost::system::error_code error;
  const asio::ip::address ip = asio::ip::make_address(address, error);
  if (error)
    return Status::error("address '" + address + "': expected an IP address like 192.168.0.20");
  if (port == 0) return Status::error("address '" + address + "': port 0, expected 1 to 65535");
  const asio::ip::udp::endpoint peer(ip, port);
  auto& udp = socket_->udp;
  udp.open(peer.protocol(), error);
  if (!error) udp.set_option(asio::socket_base::receive_buffer_size(receive_buffer), error);
  if (!error) udp.non_blocking(true, error);
  if (!error) udp.connect(peer, error);
  if (!error) {
    drop_waiting();
    return Status::ok();
  }
  close();
  return Status::error(address + ":" + std::to_string(port) + ": " + error.message());
}

// The system gives the socket its port first and its peer after that: anybody may have come
// between.
void UdpClient::drop_waiting() noexcept {
  constexpr int kMost = 1000;  // more than a receive buffer holds
  std::uint8_t byte = 0;
  PacketTap* const tap = std::exchange(tap_, nullptr);
  for (int i = 0; i < kMost && receive({&byte, 1}); ++i) {
  }
  tap_ = tap;
}

bool UdpClient::send(std::span<const std::uint8_t> bytes) noexcept {
  boost::system::error_code error;
  socket_->udp.send(asio::buffer(bytes.data(), bytes.size()), 0, error);
  // A peer that was not there yet leaves its refusal in the socket; it belongs to an earlier
  // datagram.
  if (error == asio::error::connection_refused) {
    socket_->udp.send(asio::buffer(bytes.data(), bytes.size()), 0, error);
  }
  if (!error && tap_ != nullptr) tap_->keep(out_, monotonic_now(), bytes);
  return !error;
}

std::optional<std::size_t> UdpClient::receive(std::span<std::uint8_t> buffer) noexcept {
  for (int attempt = 0; attempt < 2; ++attempt) {
    boost::system::error_code error;
    const std::size_t size =
        socket_->udp.receive(asio::buffer(buffer.data(), buffer.size()), 0, error);
    if (!error) {
      if (tap_ != nullptr) tap_->keep(in_, monotonic_now(), buffer.first(size));
      return size;
    }
    if (error != asio::error::connection_refused) break;
  }
  return std::nullopt;
}

void UdpClient::wait(Nanos timeout) noexcept {
  const Nanos span = std::max<Nanos>(timeout, 0);
  const timespec limit{span / kSecond, span % kSecond};
  pollfd entry{socket_->udp.is_open() ? socket_->udp.native_handle() : -1, POLLIN, 0};
  ppoll(&entry, 1, &limit, nullptr);
}

void UdpClient::keep(PacketTap* tap, PacketWay in, PacketWay out) noexcept {
  tap_ = tap;
  in_ = in;
  out_ = out;
}

void UdpClient::close() noexcept {
  boost::system::error_code ignored;
  socket_->udp.close(ignored);
}

}  // namespace handrail
