// The one place that reads the clocks. Daemons, drivers and transports only.
#pragma once

#include "server/base/time.h"

namespace handrail {

// Now on CLOCK_BOOTTIME: unaffected by changes of the wall clock, and it goes on while the computer
// sleeps, so that what was known before is as old as it is. Real-time safe.
Nanos monotonic_now() noexcept;

// The calendar's time since 1970-01-01 UTC, which may be wrong and may leap: to be shown, and never
// for decisions. Real-time safe.
Nanos calendar_now() noexcept;

}  // namespace handrail
