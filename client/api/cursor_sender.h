// A hand that is led through the master's device `page`, as a browser does it, in a thread of its
// own: an order that waits for its answer must not let the dead-man go.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "client/api/operator_client.h"
#include "server/base/spatial.h"

namespace handrail {

// A simulated hand moves in steps of a millisecond; a wait for an answer is not caught up.
inline constexpr Nanos kHandStep = kMillisecond;
inline constexpr Nanos kLongestHandStep = 50 * kMillisecond;

class CursorSender {
 public:
  // Sends nothing before the first set().
  CursorSender(const MasterPlace& master, const std::string& as);
  ~CursorSender();
  CursorSender(const CursorSender&) = delete;
  CursorSender& operator=(const CursorSender&) = delete;

  // Where the hand is from now on, frame M, turned from how the device is held at first.
  void set(const Pose& X_MC);

 private:
  void run();

  OperatorClient client_;
  std::mutex mutex_;
  Pose X_MC_;
  bool set_ = false;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace handrail
