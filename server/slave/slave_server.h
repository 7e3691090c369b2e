// The slave's IO thread: the link a thousand times a second, the force sensor, scenes and signals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "devices/ft_sensor.h"
#include "server/base/status.h"
#include "server/slave/mailboxes.h"

namespace handrail {

struct SlaveServerOptions {
  std::string address = "127.0.0.1";  // loopback
  std::uint16_t port = 0;             // 0 = any free one
  // Our scene of that name; the error says why there is none. Called in the IO thread, while
  // nothing moves, when the master's scene differs from the one in the robot loop.
  std::function<Result<FollowSettings>(const std::string& scene)> load_scene;
};

class SlaveServer {
 public:
  // Mailboxes and sensor (null: none) must outlive the server.
  SlaveServer(SlaveMailboxes& boxes, FtSensor* sensor, SlaveServerOptions options);
  ~SlaveServer();

  // Binds the link's port. The error names address or port and what was expected.
  Status open();
  std::uint16_t port() const;

  // Serves until `finished` says so, asked a thousand times a second. SIGINT and SIGTERM call
  // `on_signal` in this thread.
  void run(std::function<void()> on_signal, std::function<bool()> finished);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handrail
