// Time as an argument: nanoseconds of a monotonic clock that only daemons read.
#pragma once

#include <cstdint>

namespace handrail {

// A point in monotonic time, or a span of it. 64 bits last 292 years.
using Nanos = std::int64_t;

inline constexpr Nanos kMicrosecond = 1'000;
inline constexpr Nanos kMillisecond = 1'000'000;
inline constexpr Nanos kSecond = 1'000'000'000;

// A span that means "never happened": larger than any real age, far from overflow when added to.
inline constexpr Nanos kForever = INT64_MAX / 4;

inline constexpr double to_seconds(Nanos t) { return static_cast<double>(t) * 1e-9; }
inline constexpr Nanos from_seconds(double s) { return static_cast<Nanos>(s * 1e9); }

}  // namespace handrail
