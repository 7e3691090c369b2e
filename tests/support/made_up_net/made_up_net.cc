#include "tests/support/made_up_net/made_up_net.h"

#include <sys/time.h>

namespace handrail {

Nanos test::wall_clock = 1'700'000'000 * kSecond;

}  // namespace handrail

// libssl asks this one: of two of a name the program's own is taken.
extern "C" int gettimeofday(timeval* now, void*) noexcept {
  now->tv_sec = handrail::test::wall_clock / handrail::kSecond;
  now->tv_usec = handrail::test::wall_clock % handrail::kSecond / handrail::kMicrosecond;
  return 0;
}
