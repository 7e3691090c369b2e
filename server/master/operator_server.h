// The master's end of the operator protocol: u32 length, little-endian, then that many bytes of
// protobuf, at most 64 KiB; one Reply for each Request, in order.
#pragma once

#include <sys/socket.h>

#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/operator.pb.h"
#include "server/base/length_prefix.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/link/path_socket.h"
#include "server/master/memory_reserve.h"
#include "server/master/request_stream.h"

namespace handrail {

// Whether who asked has not hung up. Empty: they never do. To be called in the IO thread.
using StillWaits = std::function<bool()>;

// Carries out orders. `handle` runs in the IO thread and must not block; `reply` may be called at
// once or later, from any thread, as long as the io_context lives. Only its first call counts.
// Dropping it without a call, at any time, closes the client's connection.
class OperatorHandler {
 public:
  virtual ~OperatorHandler() = default;
  virtual void handle(const pb::Request& request, std::function<void(pb::Reply)> reply,
                      StillWaits waits) = 0;
  // True when an order in the name `as` (none: a request that does not say) is not refused for the
  // lease: that name holds it, or nobody does. Asked in the IO thread, for every client whenever
  // one has to go.
  virtual bool may_drive(const std::optional<std::string>& as) const = 0;
};

// Whoever comes is let in. Where there is no room, the client goes that was not heard for longest;
// the last to go are those who wait for the answer to a stop, and before them those who give orders
// and may. A stop is served before all else; of the rest those first who give orders and may, and
// no more in a millisecond than leave time for the link. A client that sends garbage is told so and
// cut off, one that stops in the middle of a frame is cut off after 2 s; neither delays the others.
// When memory runs out, those go first who hold most of it and neither drive nor wait for a stop.
// All methods in the IO thread or while it does not run.
class OperatorServer {
 public:
  static constexpr std::size_t kMaxClients = 1024;
  static constexpr Nanos kPatience = 2 * kSecond;  // for the rest of a frame
  // A status takes some 50 us to put together.
  static constexpr int kRequestsPerMs = 8;

  // Both must outlive the server.
  OperatorServer(boost::asio::io_context& io, OperatorHandler& handler,
                 std::size_t max_clients = kMaxClients);
  ~OperatorServer();

  // Claims the socket and accepts clients whenever the io_context runs.
  Status start(const std::string& path);
  // A connection that came over the network, of who is `speaker` by a key. Throws std::bad_alloc;
  // the connection is closed then.
  void admit(boost::asio::local::stream_protocol::socket socket, Trusted speaker);
  // Closes every connection and removes the socket file. Safe to call twice.
  void stop();
  std::size_t clients() const;

 private:
  class Client;
  void accept();
  // kNoMeans: no descriptor for who waits.
  enum class Admitted { kOne, kNobodyWaits, kNoMeans };
  Admitted admit_one();
  void take_in(std::shared_ptr<Client> client);
  // Lets the client go that is needed least.
  void dismiss_one();
  // After memory ran out: lets go of as many as it takes to have some in reserve again.
  void regain_memory();
  // A whole request has come.
  void take(const std::shared_ptr<Client>& client);
  void serve_waiting();

  OperatorHandler& handler_;
  const std::size_t max_clients_;
  bool said_full_ = false, said_short_ = false;
  // As much as one client may hold.
  MemoryReserve reserve_{kMaxFrame};
  PathSocket file_{{SOCK_STREAM, "operator socket", "another master"}};
  boost::asio::local::stream_protocol::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  std::vector<std::shared_ptr<Client>> clients_;
  // Whose requests wait for their turn: of who drives, and of all others.
  std::deque<std::weak_ptr<Client>> driving_, others_;
  int turns_ = kRequestsPerMs;  // left in this millisecond
  boost::asio::steady_timer next_turns_;
  std::shared_ptr<int> running_;  // handlers still queued after stop find it gone
};

}  // namespace handrail
