// What the kernel's driver comedi_test gives at its inputs 0 and 1, in closed form.
//
// Source: drivers/comedi/drivers/comedi_test.c of Linux 6.1: amplitude 1 V, period 0.1 s, range
// +-10 V, 16 bits, its own integer arithmetic.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace handrail::kernel {

inline constexpr double kWavePeriod = 100'000.0;                        // [us]
inline constexpr unsigned int kWaveMiddle = 32767;                      // 65535 / 2
inline constexpr unsigned int kWaveAmplitude = 65535u * 1000 / 20'000;  // 1 V of 20: 3276

inline double wave_volts(unsigned int raw) { return -10.0 + 20.0 * raw / 65535.0; }

// `us` into the period, a whole number below it.
inline unsigned int sawtooth(std::uint64_t us) {
  return kWaveMiddle - kWaveAmplitude +
         static_cast<unsigned int>(us * 2 * kWaveAmplitude / 100'000);
}
inline unsigned int square(std::uint64_t us) {
  return us < 50'000 ? kWaveMiddle - kWaveAmplitude : kWaveMiddle + kWaveAmplitude;
}

// How far into its period a sawtooth of so many volts is, to about 15 us [us].
inline double wave_phase(double volts) {
  const double raw = (volts + 10.0) * 65535.0 / 20.0;
  return (raw - (kWaveMiddle - kWaveAmplitude) + 0.5) * kWavePeriod / (2.0 * kWaveAmplitude);
}

// Follows readings: each is as much later as it says, or something was lost.
class WaveWatch {
 public:
  // Room for the rounding of two readings [us].
  static constexpr double kRounding = 32.0;

  // The next reading of inputs 0 and 1, `us` after the last, `apart` us from each other. False: it
  // is not what the closed form has.
  bool next(double saw, double other, double us, double apart) {
    const double phase = wave_phase(saw);
    bool good = phase > -kRounding && phase < kWavePeriod + kRounding;
    if (began_) {
      const double off = std::remainder(phase - last_ - us, kWavePeriod);
      good = good && std::abs(off) < kRounding;
    }
    began_ = true;
    last_ = phase;
    // Near an edge either side is right.
    const double there = std::fmod(phase + apart, kWavePeriod);
    const bool near_edge = std::abs(std::remainder(there, kWavePeriod / 2.0)) < kRounding;
    const double wanted = wave_volts(square(static_cast<std::uint64_t>(std::max(0.0, there))));
    return good && (near_edge || std::abs(other - wanted) < 1e-9);
  }

 private:
  bool began_ = false;
  double last_ = 0.0;
};

}  // namespace handrail::kernel
