// The master's IO thread: the link a thousand times a second, operators and signals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/base/status.h"
#include "server/master/mailboxes.h"
#include "server/master/order_desk.h"

namespace handrail {

struct MasterServerOptions {
  std::string address = "127.0.0.1";        // own; loopback
  std::uint16_t port = 0;                   // own; 0 = any free one
  std::string slave_address = "127.0.0.1";  // loopback
  std::uint16_t slave_port = 0;
  std::string operator_socket;
};

class MasterServer {
 public:
  // Mailboxes and desk must outlive the server.
  MasterServer(MasterMailboxes& boxes, OrderDesk& desk, MasterServerOptions options);
  ~MasterServer();

  // Binds the link's port and claims the operators' socket. The error names place and cause.
  Status open();
  std::uint16_t port() const;

  // Serves until `finished` says so, asked a thousand times a second. ending_signals() call
  // `on_signal` in this thread.
  // `alive` hears at every tick whether the control loop runs.
  void run(std::function<void()> on_signal, std::function<bool()> finished,
           std::function<void(Nanos now, bool runs)> alive = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handrail
