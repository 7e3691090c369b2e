#include "devices/input/turn_bell.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

#include "server/base/clock.h"

namespace handrail {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t));

void TurnBell::ring(std::uint32_t number) noexcept {
  // In one order with wait(): either it sees the number, or this sees that it waits.
  number_.store(number, std::memory_order_seq_cst);
  if (!waits_.load(std::memory_order_seq_cst)) return;
  ::syscall(SYS_futex, &number_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
}

bool TurnBell::wait(std::uint32_t old, Nanos until) noexcept {
  if (now() != old) return true;
  waits_.store(true, std::memory_order_seq_cst);
  while (number_.load(std::memory_order_seq_cst) == old) {
    const Nanos left = until - monotonic_now();
    if (left <= 0) break;
    const timespec most{left / kSecond, left % kSecond};
    ::syscall(SYS_futex, &number_, FUTEX_WAIT_PRIVATE, old, &most, nullptr, 0);
  }
  waits_.store(false, std::memory_order_relaxed);
  return now() != old;
}

}  // namespace handrail
