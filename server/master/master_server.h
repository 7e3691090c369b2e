// The master's IO thread: the link a thousand times a second, operators and signals.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/daemon/io_thread.h"
#include "server/link/transport.h"
#include "server/master/handle/handle_watch.h"
#include "server/master/mailboxes.h"
#include "server/master/order_desk.h"
#include "server/master/remote_operator_server.h"
#include "server/packets/packet_tap.h"

namespace handrail {

struct MasterServerOptions {
  TransportMaker link;  // the master's end
  std::string operator_socket;
  std::string slave_at;                                   // where a slave is looked for
  std::optional<RemoteOperatorOptions> remote_operators;  // none: this computer's only
  bool busy_poll = false;                                 // as in the configuration
  const Recorder* recorder = nullptr;  // the slave records when it is asked to; not owned
  PacketTap* packets = nullptr;        // where the link's datagrams are left; null: nowhere
  FtSensor* handle = nullptr;          // on the device's handle, started; null: none; not owned
  HandleWatchOptions handle_watch = {};
};

// Mailboxes and desk must outlive the server.
std::unique_ptr<IoServer> make_master_server(MasterMailboxes& boxes, OrderDesk& desk,
                                             MasterServerOptions options);

}  // namespace handrail
