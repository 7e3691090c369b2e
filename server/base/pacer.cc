#include "server/base/pacer.h"

#include <cerrno>
#include <ctime>

namespace handrail {

std::int64_t Pacer::woke(Nanos now) noexcept {
  ++ticks_;
  lateness_.add(now - due_);
  const std::int64_t missed = now < due_ ? 0 : (now - due_) / period_;
  due_ += (missed + 1) * period_;
  if (missed == 0) {
    consecutive_ = 0;
    return 0;
  }
  ++overruns_;
  ++consecutive_;
  missed_ += static_cast<std::uint64_t>(missed);
  return missed;
}

void sleep_until(Nanos time) noexcept {
  const timespec until{time / kSecond, time % kSecond};
  while (clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace handrail
