#include "devices/rig/switches_server.h"

#include <array>
#include <utility>

#include <boost/asio.hpp>

namespace handrail {

namespace {

using boost::asio::ip::tcp;
using AsioError = boost::system::error_code;

}  // namespace

struct SwitchesServer::Impl : std::enable_shared_from_this<Impl> {
  struct Connection {
    explicit Connection(tcp::socket s) : socket(std::move(s)) {}
    tcp::socket socket;
    PeerId peer = 0;
    std::array<char, kMostOrder> order{};
  };

  Impl(boost::asio::io_context& io, Told t) : acceptor(io), told(std::move(t)) {}

  void accept() {
    acceptor.async_accept([self = shared_from_this()](const AsioError& error, tcp::socket socket) {
      if (error) return;
      self->begin(std::move(socket));
      self->accept();
    });
  }

  void begin(tcp::socket socket) {
    if (connections == kMostConnections) return;  // closes it
    AsioError error;
    socket.non_blocking(true, error);
    if (error) return;
    ++connections;
    const auto connection = std::make_shared<Connection>(std::move(socket));
    connection->peer = ++last_peer;
    read(connection);
  }

  void read(const std::shared_ptr<Connection>& c) {
    c->socket.async_read_some(
        boost::asio::buffer(c->order),
        [self = shared_from_this(), c](const AsioError& error, std::size_t size) {
          if (error || !self->serve(*c, {c->order.data(), size})) {
            --self->connections;
            if (self->told.left) self->told.left(c->peer);
            return;
          }
          self->read(c);
        });
  }

  bool serve(Connection& c, std::string_view order) {
    const std::string answer = told.answer(order, c.peer);
    AsioError error;
    return answer.empty() ||
           c.socket.write_some(boost::asio::buffer(answer), error) == answer.size();
  }

  tcp::acceptor acceptor;
  Told told;
  int connections = 0;
  PeerId last_peer = 0;
};

SwitchesServer::SwitchesServer(boost::asio::io_context& io, Told told)
    : impl_(std::make_shared<Impl>(io, std::move(told))) {}

SwitchesServer::~SwitchesServer() {
  AsioError ignored;
  impl_->acceptor.close(ignored);
}

Status SwitchesServer::open(const std::string& address, std::uint16_t port) {
  AsioError error;
  const auto ip = boost::asio::ip::make_address_v4(address, error);
  const std::string place = "command port " + address + ":" + std::to_string(port);
  if (error) return Status::error(place + ": expected an IPv4 address like 127.0.0.1");
  tcp::acceptor& a = impl_->acceptor;
  a.open(tcp::v4(), error);
  if (!error) a.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) a.bind({ip, port}, error);
  if (!error) a.listen(kMostConnections, error);
  if (error) {
    AsioError ignored;
    a.close(ignored);
    return Status::error(place + ": " + error.message());
  }
  impl_->accept();
  return Status::ok();
}

std::uint16_t SwitchesServer::port() const {
  AsioError error;
  const auto at =
      impl_->acceptor.is_open() ? impl_->acceptor.local_endpoint(error) : tcp::endpoint();
  return error ? 0 : at.port();
}

}  // namespace handrail
