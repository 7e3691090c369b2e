// The slave's IO thread: the link a thousand times a second, the force sensor, scenes and signals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "devices/ft_sensor.h"
#include "server/base/status.h"
#include "server/daemon/io_thread.h"
#include "server/link/transport.h"
#include "server/packets/packet_tap.h"
#include "server/slave/mailboxes.h"
#include "server/slave/silence_watch.h"

namespace handrail {

struct SlaveServerOptions {
  TransportMaker link;              // the slave's end
  std::string robot = "the robot";  // in what is said
  // Lines of the log that were lost so far; empty: nobody counts.
  std::function<std::uint64_t()> log_lost = {};
  // Our scene of that name; the error says why there is none. Called in the IO thread, first while
  // nothing moves, when the master's scene differs from the one in the robot loop. Must not wait:
  // asked again every tick while it gives nothing, as the disk takes its time.
  std::function<std::optional<Result<FollowSettings>>(const std::string& scene)> load_scene;
  SilenceWatch::Ask why_silent = {};  // asks the controller, in the IO thread; empty: nobody does
  bool busy_poll = false;             // as in the configuration
  PacketTap* packets = nullptr;       // where the link's datagrams are left; null: nowhere
};

// Mailboxes and sensor (null: none) must outlive the server.
std::unique_ptr<IoServer> make_slave_server(SlaveMailboxes& boxes, FtSensor* sensor,
                                            SlaveServerOptions options);

}  // namespace handrail
