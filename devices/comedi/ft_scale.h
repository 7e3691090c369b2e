// From what a card's converters give to forces and torques.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "devices/comedi/comedi_api.h"
#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

using FtSix = Eigen::Matrix<double, 6, 1>;     // force x, y, z, torque x, y, z
using FtMatrix = Eigen::Matrix<double, 6, 6>;  // [N/V], [N m/V]
using FtCounts = std::array<unsigned int, 6>;  // as the card gives them

// What FtSample::status of a sensor at a card says. The low six bits: the axis is at its end.
inline constexpr std::uint32_t kFtSettling = 0x100;  // the card does not give readings yet
inline constexpr std::uint32_t kFtLost = 0x200;      // card or sensor is gone

// Low pass 1 to 6 of a JR3; 0: none [Hz].
inline constexpr std::array<double, 7> kJr3Cutoffs = {0.0,    500.0,    125.0,     31.25,
                                                      7.8125, 1.953125, 0.48828125};

// Channel of the kernel's driver jr3_pci: eight a filter, forces and moments x, y, z first.
constexpr unsigned int jr3_channel(unsigned int filter, unsigned int axis) {
  return filter * 8 + axis;
}

// 16384 counts are the full scale; the driver adds as many, so that nothing is negative.
inline constexpr int kJr3Full = 16384;

// Full scale of an axis [N or N m] from the range of its channel, which the driver has in kN and
// kN m.
constexpr double jr3_full_scale(const ComediRange& range) { return 1e3 * range.max; }

struct FtReading {
  FtSix value = FtSix::Zero();  // [N], [N m]
  std::uint32_t saturated = 0;  // a bit for each axis
};

// `full_scale` [N], [N m]. An axis at full scale, or one count from it, tells nothing more. The
// driver adds without looking: counts below what it can tell come as large numbers, and are taken
// for what they are.
inline FtReading jr3_reading(const FtCounts& raw, const FtSix& full_scale) noexcept {
  FtReading out;
  for (unsigned int i = 0; i < raw.size(); ++i) {
    const std::int64_t counts = std::int64_t{static_cast<std::int32_t>(raw[i])} - kJr3Full;
    if (counts >= kJr3Full - 1 || counts <= -kJr3Full + 1) out.saturated |= 1u << i;
    out.value[i] = full_scale[i] * static_cast<double>(counts) / kJr3Full;
  }
  return out;
}

// A converter's number as a voltage, or any other quantity of its range.
inline double comedi_value(unsigned int raw, const ComediRange& range,
                           unsigned int max_data) noexcept {
  return range.min + (range.max - range.min) * raw / max_data;
}

// The number that is nearest to a value, which is kept within the range.
inline unsigned int comedi_number(double value, const ComediRange& range,
                                  unsigned int max_data) noexcept {
  const double share = (value - range.min) / (range.max - range.min);
  if (!(share > 0.0)) return 0;
  return share >= 1.0 ? max_data : static_cast<unsigned int>(share * max_data + 0.5);
}

// Six voltages, less those without any force, times the sensor's matrix. An axis is saturated
// where a converter is at its end: any of its six may be in any axis, so all of them are.
inline FtReading analog_reading(const FtSix& volts, std::uint32_t at_end, const FtSix& bias,
                                const FtMatrix& matrix) noexcept {
  return {matrix * (volts - bias), at_end == 0 ? 0u : 0x3fu};
}

// How long a low pass is still about what was before: ten of its time constants, 1.6 / cutoff.
constexpr Nanos settling_time(double cutoff_hz) {
  return cutoff_hz > 0.0 ? static_cast<Nanos>(1.6e9 / cutoff_hz) : 0;
}

}  // namespace handrail
