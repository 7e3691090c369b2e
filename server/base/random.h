// Seeded randomness for simulated devices: the same numbers on every platform.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace handrail {

// Pseudo-random generator, 32 bytes of state, no allocation. Not for secrets.
// Source: xoshiro256++ 1.0 (Blackman, Vigna), state filled by splitmix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept {
    for (std::uint64_t& word : state_) {
      seed += 0x9e3779b97f4a7c15ULL;
      std::uint64_t z = seed;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
      word = z ^ (z >> 31);
    }
  }

  // 64 uniform bits. Real-time safe.
  std::uint64_t bits() noexcept {
    const std::uint64_t out = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return out;
  }

  // Uniform in [0, 1), 53 bits. Real-time safe.
  double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  // Normal with mean 0 and standard deviation 1, finite (|x| < 8.6). Real-time safe.
  // Source: Box and Muller 1958; every call uses up two uniforms, so that the sequence has no
  // memory beyond the state.
  double normal() noexcept {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_[4];
};

}  // namespace handrail
