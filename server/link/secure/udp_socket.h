// Datagrams over UDP, IPv4 and IPv6 with one socket where the system has both.
#pragma once

#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/base/status.h"
#include "server/link/secure/datagram_socket.h"

namespace handrail {

class UdpSocket final : public DatagramSocket {
 public:
  // `io` is only used by on_readable and must outlive this.
  explicit UdpSocket(boost::asio::io_context& io) : socket_(io) {}

  // `address`: "any", for every interface, or an IPv4 or IPv6 address of this computer. `port` 0:
  // any free one. The error names address or port and what was expected.
  Status open(const std::string& address, std::uint16_t port);
  // The port bound; 0 while closed.
  std::uint16_t port() const noexcept { return port_; }
  // Calls `readable` on the io_context's thread each time datagrams may wait, until close().
  // `readable` must take all of them.
  void on_readable(std::function<void()> readable);
  void close() noexcept;

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
  bool send(std::span<const std::uint8_t> bytes, const Address& to) noexcept override;

 private:
  void wait_readable();

  boost::asio::ip::udp::socket socket_;
  std::function<void()> readable_;
  std::uint16_t port_ = 0;
  bool v6_ = false;
};

// The other way of Address: an IPv4 address as ::ffff:a.b.c.d.
Address address_of(const boost::asio::ip::udp::endpoint& endpoint) noexcept;

}  // namespace handrail
