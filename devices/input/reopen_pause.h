// How often what was unplugged is looked for.
#pragma once

#include "server/base/time.h"

namespace handrail {

// Between two attempts to open a device that is gone: a person who plugs it in does not notice it,
// and a device that is away costs next to nothing. Our choice.
inline constexpr Nanos kReopenPause = 100 * kMillisecond;

}  // namespace handrail
