// The master's end of the operator protocol: u32 length, little-endian, then that many bytes of
// protobuf, at most 64 KiB; one Reply for each Request, in order.
#pragma once

#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "proto/operator.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/master/operator_socket.h"

namespace handrail {

// Carries out orders. `handle` runs in the IO thread and must not block; `reply` may be called at
// once or later, from any thread, as long as the io_context lives. Only its first call counts.
// Dropping it without a call, at any time, closes the client's connection.
class OperatorHandler {
 public:
  virtual ~OperatorHandler() = default;
  virtual void handle(const pb::Request& request, std::function<void(pb::Reply)> reply) = 0;
};

// Serves up to 16 clients; one further replaces a client silent for 10 s, or is refused. A client
// that sends garbage is told so and cut off, one that stops in the middle of a frame is cut off
// after 2 s; neither delays the others. All methods in the IO thread or while it does not run.
class OperatorServer {
 public:
  static constexpr std::size_t kMaxClients = 16;
  static constexpr Nanos kIdle = 10 * kSecond;     // silent for this long: may be replaced
  static constexpr Nanos kPatience = 2 * kSecond;  // for the rest of a frame

  // Both must outlive the server.
  OperatorServer(boost::asio::io_context& io, OperatorHandler& handler);
  ~OperatorServer();

  // Claims the socket and accepts clients whenever the io_context runs.
  Status start(const std::string& path);
  // Closes every connection and removes the socket file. Safe to call twice.
  void stop();
  std::size_t clients() const;

 private:
  class Client;
  void accept();
  void admit(boost::asio::local::stream_protocol::socket socket);
  bool make_room();

  OperatorHandler& handler_;
  OperatorSocket file_;
  boost::asio::local::stream_protocol::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  std::vector<std::shared_ptr<Client>> clients_;
  std::shared_ptr<int> running_;  // handlers still queued after stop find it gone
};

}  // namespace handrail
