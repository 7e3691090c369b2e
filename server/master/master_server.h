// The master's IO thread: the link a thousand times a second, operators and signals.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/daemon/io_thread.h"
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

// On the link's port and the operators' socket. Mailboxes and desk must outlive the server.
std::unique_ptr<IoServer> make_master_server(MasterMailboxes& boxes, OrderDesk& desk,
                                             MasterServerOptions options);

}  // namespace handrail
