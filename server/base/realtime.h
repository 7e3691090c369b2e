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

// What the system would grant what this process starts.
struct RealtimePermission {
  bool fifo = false;        // SCHED_FIFO at the priority that was asked about
  bool lock = false;        // all of the memory
  long most_priority = 0;   // the limit on it; -1: none
  long most_locked_kb = 0;  // the limit on locked memory; -1: none
};
// Tries `priority` (1 to 99) for the calling thread, which is then as it was; changes nothing else.
RealtimePermission realtime_permission(int priority);

// What root types, on one line, so that `user` is granted it from the next log-in on.
std::string realtime_permission_line(const std::string& user);

// What to do to be granted more, where one of a program's threads lacks what matters; else empty.
std::string realtime_advice(std::initializer_list<RealtimeGrant> grants);

}  // namespace handrail
