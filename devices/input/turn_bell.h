// One thread waits for the next number that another counts to.
#pragma once

#include <atomic>
#include <cstdint>

#include "server/base/time.h"

namespace handrail {

// A number that one thread sets and another waits for; neither takes a lock. Source: futex(2).
class TurnBell {
 public:
  // By one thread: the number is now `number`, and who waits wakes. Real-time safe: a system call
  // only while somebody waits.
  void ring(std::uint32_t number) noexcept;
  std::uint32_t now() const noexcept { return number_.load(std::memory_order_acquire); }
  // By one other thread, until the number is not `old`, and no later than `until` by
  // monotonic_now(): true as soon as it is not. Real-time safe but that it waits.
  bool wait(std::uint32_t old, Nanos until) noexcept;

 private:
  std::atomic<std::uint32_t> number_{0};
  std::atomic<bool> waits_{false};
};

}  // namespace handrail
