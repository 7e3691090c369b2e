// The slave's IO thread: the link a thousand times a second, the force sensor, scenes and signals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "devices/ft_sensor.h"
#include "server/base/status.h"
#include "server/slave/mailboxes.h"

namespace handrail {

struct SlaveServerOptions {
  std::string address = "127.0.0.1";  // loopback
  std::uint16_t port = 0;             // 0 = any free one
  std::string robot = "the robot";    // in what is said
  // Lines of the log that were lost so far; empty: nobody counts.
  std::function<std::uint64_t()> log_lost = {};
  // Our scene of that name; the error says why there is none. Called in the IO thread, first while
  // nothing moves, when the master's scene differs from the one in the robot loop. Must not wait:
  // asked again every tick while it gives nothing, as the disk takes its time.
  std::function<std::optional<Result<FollowSettings>>(const std::string& scene)> load_scene;
};

class SlaveServer {
 public:
  // Mailboxes and sensor (null: none) must outlive the server.
  SlaveServer(SlaveMailboxes& boxes, FtSensor* sensor, SlaveServerOptions options);
  ~SlaveServer();

  // Binds the link's port. The error names address or port and what was expected.
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
