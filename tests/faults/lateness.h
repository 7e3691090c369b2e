// How late this machine schedules who must not be late, while a row runs.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/base/time.h"

namespace handrail::faults {

// A wake-up that came late.
struct Late {
  Nanos due = 0;
  Nanos late = 0;  // it came so long after
};

// Wake-ups of one or several threads. What is not in it was on time.
class LatenessLog {
 public:
  explicit LatenessLog(std::vector<Late> all = {});

  // The worst that was waiting or woke in [from, to]; 0: all were on time.
  Nanos worst(Nanos from, Nanos to) const;
  Nanos worst() const;

 private:
  std::vector<Late> all_;  // by due
  Nanos longest_ = 0;
};

// A thread on each processor that wants to wake every millisecond: what keeps it waiting keeps the
// daemons waiting. `real_time`: with the priority of their IO threads, where that is granted.
class LatenessProbe {
 public:
  explicit LatenessProbe(bool real_time = true);
  ~LatenessProbe();
  LatenessProbe(const LatenessProbe&) = delete;
  LatenessProbe& operator=(const LatenessProbe&) = delete;

  // Ends it; once.
  LatenessLog finish();

 private:
  struct Thread {
    std::thread thread;
    std::vector<Late> found;
  };
  void run(Thread& thread, unsigned processor);

  bool real_time_;
  std::atomic<bool> ended_{false};
  std::vector<std::unique_ptr<Thread>> threads_;
};

}  // namespace handrail::faults
