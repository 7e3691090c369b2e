// What the operating system grants a thread that must not be late.
#pragma once

#include <initializer_list>
#include <string>

namespace handrail {

// What a thread really got.
struct RealtimeGrant {
  bool memory_locked = false;  // present and future pages
  bool fifo = false;           // SCHED_FIFO at `priority`
  int priority = 0;
  bool fine_timers = false;  // timer slack of 1 ns
  std::string report;        // one line for status and log, with the cause of whatever was refused
};

// Asks for all of it for the calling thread: memory locked (the whole process), SCHED_FIFO at
// `priority` (1 to 99), timer slack of 1 ns. Whatever is refused is left as it was and said in the
// report; the thread goes on either way. Threads it starts afterwards are ordinary ones. Call once
// at the start of a thread; not real-time safe itself.
RealtimeGrant enter_realtime(int priority);

// What to do to be granted more, where one of a program's threads lacks what matters; else empty.
std::string realtime_advice(std::initializer_list<RealtimeGrant> grants);

}  // namespace handrail
