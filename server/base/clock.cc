#include "server/base/clock.h"

#include <ctime>

namespace handrail {

namespace {

Nanos now_on(clockid_t clock) noexcept {
  timespec ts{};
  clock_gettime(clock, &ts);
  return Nanos{ts.tv_sec} * kSecond + ts.tv_nsec;
}

}  // namespace

Nanos monotonic_now() noexcept { return now_on(CLOCK_BOOTTIME); }
Nanos calendar_now() noexcept { return now_on(CLOCK_REALTIME); }

}  // namespace handrail
