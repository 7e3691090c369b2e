// The one place that reads the monotonic clock. Daemons, drivers and transports only.
#pragma once

#include "server/base/time.h"

namespace handrail {

// Now on CLOCK_MONOTONIC: unaffected by changes of the wall clock. Real-time safe.
Nanos monotonic_now() noexcept;

}  // namespace handrail
