// Rounding to the 32-bit floats of a wire.
#pragma once

namespace handrail {

// Through memory: g++ 12 at -O3 forgets to round the last two of six numbers that are rounded and
// read back in sight of each other, by Eigen's cast<float>().cast<double>() as well. Real-time
// safe.
inline float in_32_bits(double v) noexcept {
  volatile float rounded = static_cast<float>(v);
  return rounded;
}

}  // namespace handrail
