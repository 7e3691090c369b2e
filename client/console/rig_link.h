// The gateway's conversation with the simulated rig, in a thread of its own.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "proto/console.pb.h"

namespace handrail {

// Asks the rig 60 times a second what happens at its workpiece, and has it play that of the scene
// that the master has. Nobody waits for it.
class RigLink {
 public:
  // `tell` runs in the thread that `post` has.
  using Post = std::function<void(std::function<void()>)>;
  using Tell = std::function<void(const pb::RigNews&)>;

  RigLink(std::string socket, Post post, Tell tell);
  ~RigLink();
  RigLink(const RigLink&) = delete;
  RigLink& operator=(const RigLink&) = delete;

  // The master's scene. Where the rig refuses it, it is asked again until it is another one.
  void follow(const std::string& scene);

 private:
  void run();
  std::string followed();

  const std::string socket_;
  const Post post_;
  const Tell tell_;
  std::mutex mutex_;
  std::string scene_;  // empty: none is known
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace handrail
