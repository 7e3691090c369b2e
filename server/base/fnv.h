// FNV-1a, 64 bits: a fast, fixed hash for comparing configurations. Not cryptographic.
// Source: Fowler, Noll, Vo; offset basis 14695981039346656037, prime 1099511628211.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace handrail {

class Fnv {
 public:
  Fnv& byte(std::uint8_t b) noexcept {
    h_ = (h_ ^ b) * 1099511628211ULL;
    return *this;
  }
  Fnv& u64(std::uint64_t v) noexcept {
    for (int i = 0; i < 8; ++i) byte(static_cast<std::uint8_t>(v >> (8 * i)));
    return *this;
  }
  // By value: 0.0 and -0.0 are the same number.
  Fnv& f64(double v) noexcept { return u64(std::bit_cast<std::uint64_t>(v == 0.0 ? 0.0 : v)); }
  Fnv& text(std::string_view s) noexcept {
    for (const char c : s) byte(static_cast<std::uint8_t>(c));
    return u64(s.size());
  }
  std::uint64_t value() const noexcept { return h_; }

 private:
  std::uint64_t h_ = 14695981039346656037ULL;
};

}  // namespace handrail
