// The rig's status socket: what happens at the workpiece, and which one it is (proto/rig.proto).
#pragma once

#include <memory>
#include <string>

#include "devices/rig/rig_status_io.h"
#include "server/base/status.h"

namespace handrail {

// Serves in a thread of its own, with ordinary priority; the rig's thread never waits for it. Of
// root and this user alone: the file's mode is 0600, and of who comes the kernel says who it is. At
// most kMostClients at once: where there is no room, who was not heard for longest makes room. Who
// stops in the middle of an order, or does not take an answer, goes after kRigPatience.
class RigStatusServer {
 public:
  static constexpr std::size_t kMostClients = 16;
  static constexpr std::size_t kMostOrder = 4096;  // [bytes]
  static constexpr Nanos kRigPatience = 2 * kSecond;

  // `feed` must outlive it.
  RigStatusServer(RigFeed& feed, std::string scene, RigBoard::FindWorkpiece find);
  // Ends the thread and removes the socket.
  ~RigStatusServer();
  RigStatusServer(const RigStatusServer&) = delete;
  RigStatusServer& operator=(const RigStatusServer&) = delete;

  // Claims the socket, and serves from here on. The error names path and cause.
  Status start(const std::string& path);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handrail
