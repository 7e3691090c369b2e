// The simulated laboratory on the network: the rig behind two UDP sockets, in real time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "devices/rig/rig.h"
#include "devices/rig/rig_feed.h"
#include "server/base/status.h"

namespace handrail {

class RigServer {
 public:
  explicit RigServer(const RigOptions& options);
  ~RigServer();

  // Binds both sockets; port 0 takes any free one. `address` is IPv4. The error names what could
  // not be bound and why.
  Status open(const std::string& address, std::uint16_t robot_port, std::uint16_t sensor_port);
  // The controller's own switches, over TCP, at the same kind of address. Before run(). The error
  // names what could not be had and why; without them the controller serves.
  Status open_switches(const std::string& address, std::uint16_t port);
  // From here on every control cycle is told in the file at `path`. Before run(). The error names
  // file and cause.
  Status open_tap(const std::string& path);
  // From here on run() tells `feed`, which must outlive it, every moment at the workpiece, and puts
  // those in their place that come from there. Before run().
  void tell(RigFeed& feed);
  std::uint16_t robot_port() const;
  std::uint16_t sensor_port() const;
  // 0: the switches are not on the network.
  std::uint16_t command_port() const;

  // ending_signals() end run(); SIGUSR1 is the operator's alarm reset; SIGUSR2 pulls both cables,
  // the next one plugs them in: the rig goes on, and neither hears nor is heard. Before run().
  void handle_signals();
  // Serves until stop(); the rig's time begins with the call.
  void run();
  // Ends run(). From any thread.
  void stop();
  // Has run()'s thread call `f` on the rig soon. From any thread.
  void post(std::function<void(Rig&)> f);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handrail
