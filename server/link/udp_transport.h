// The link over UDP, on this computer only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include <boost/asio.hpp>

#include "server/base/status.h"
#include "server/link/transport.h"

namespace handrail {

struct UdpTransportOptions {
  std::string address = "127.0.0.1";  // own; loopback
  std::uint16_t port = 0;             // own; 0 = any free one
  std::string peer_address = {};      // empty: learned from accepted datagrams
  std::uint16_t peer_port = 0;        // not 0 when peer_address is given
};

// The link is plain: neither encrypted nor authenticated. Addresses beyond loopback are therefore
// refused, own and peer's, and datagrams from them dropped.
class UdpTransport : public Transport {
 public:
  // `io` is only used by async_wait and must outlive this.
  explicit UdpTransport(boost::asio::io_context& io) : socket_(io) {}

  // Binds the socket. The error names address or port and what was expected.
  Status open(const UdpTransportOptions& options);
  // The port bound; 0 while closed.
  std::uint16_t port() const noexcept { return port_; }
  // Calls `readable` on the io_context's thread each time datagrams may wait, until close().
  // `readable` must take all of them.
  void on_readable(std::function<void()> readable);
  void close() noexcept;

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
  void adopt_sender() noexcept override;
  bool send(std::span<const std::uint8_t> bytes) noexcept override;
  bool answer(std::span<const std::uint8_t> bytes) noexcept override;
  std::uint16_t peer_port() const noexcept override { return peer_known_ ? peer_.port() : 0; }

 private:
  using Endpoint = boost::asio::ip::udp::endpoint;

  void wait_readable();
  bool send_to(std::span<const std::uint8_t> bytes, const Endpoint& to) noexcept;

  boost::asio::ip::udp::socket socket_;
  std::function<void()> readable_;
  std::uint16_t port_ = 0;
  Endpoint peer_;
  Endpoint sender_;
  bool peer_known_ = false;
  bool peer_fixed_ = false;
};

}  // namespace handrail
