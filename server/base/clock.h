// The one place that reads the monotonic clock. Daemons, drivers and transports only.
#pragma once

#include "server/base/time.h"

namespace handrail {

// Now on CLOCK_BOOTTIME: unaffected by changes of the wall clock, and it goes on while the computer
// sleeps, so that what was known before is as old as it is. Real-time safe.
Nanos monotonic_now() noexcept;

}  // namespace handrail
