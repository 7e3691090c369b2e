// What a service manager is told (sd_notify(3)), where there is one.
#pragma once

#include <string>

#include "server/base/time.h"

namespace handrail {

// Speaks to the socket that NOTIFY_SOCKET names; without one it does nothing. Never waits. For one
// thread, but for its making.
class ServiceSocket {
 public:
  // Reads NOTIFY_SOCKET and WATCHDOG_USEC.
  ServiceSocket();
  ~ServiceSocket();
  ServiceSocket(const ServiceSocket&) = delete;
  ServiceSocket& operator=(const ServiceSocket&) = delete;

  void ready() noexcept { send("READY=1"); }
  void stopping() noexcept { send("STOPPING=1"); }
  // Asked about every tick of the IO thread. `runs`: the control loop does. While it does, the
  // watchdog hears so four times in its time, and at least every 20 ms: one that asks for less
  // hears of a stall by silence within 50 ms.
  void tick(Nanos now, bool runs) noexcept;

 private:
  void send(const char* text) noexcept;

  int socket_ = -1;
  Nanos pause_ = 0;  // between two signs; 0: nobody asks for them
  Nanos next_ = 0;
};

}  // namespace handrail
