#include "server/base/clock.h"

#include <ctime>

namespace handrail {

Nanos monotonic_now() noexcept {
  timespec ts{};
  clock_gettime(CLOCK_BOOTTIME, &ts);
  return Nanos{ts.tv_sec} * kSecond + ts.tv_nsec;
}

}  // namespace handrail
