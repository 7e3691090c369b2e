// What the IO thread of either daemon does.
#pragma once

#include <functional>
#include <string>

#include "server/base/realtime.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/daemon/run_daemon.h"
#include "server/daemon/service_socket.h"

namespace handrail {

// The link must not starve on a busy machine.
inline constexpr int kIoPriority = 70;

// What a server asks and tells while it serves, all in its own thread.
struct ServerHooks {
  std::function<void()> on_signal;  // of ending_signals()
  std::function<bool()> finished;   // asked a thousand times a second: serve no longer
  // At every tick: whether the control loop runs.
  std::function<void(Nanos now, bool runs)> alive = {};
  RealtimeGrant control = {}, io = {};  // what the two threads have
};

// One side's end of the link, and all else that its daemon's IO thread looks after.
class IoServer {
 public:
  virtual ~IoServer() = default;

  // Takes its ports and paths. The error names the one that it cannot have, and why.
  virtual Status open() = 0;
  virtual std::string place() const = 0;  // of the link
  // Serves until `hooks` say so.
  virtual void run(ServerHooks hooks) = 0;
};

// The thread that the daemon is there for.
struct ControlThread {
  std::string name;  // in what is said
  RealtimeGrant realtime;
  std::function<void()> request_stop;
  std::function<bool()> finished;
};

// What tells others that the daemon is ready, runs and ends. Takes what it needs when it is made.
class DaemonNews {
 public:
  // To be called in the IO thread, once everything runs: tells it with `ready_line`, has what this
  // thread may have of real time, says in the log what the threads have, and serves until `control`
  // has finished.
  void serve(IoServer& server, const std::string& ready_line, const ControlThread& control);

 private:
  ServiceSocket notice_;
  Announcement ready_;
};

}  // namespace handrail
