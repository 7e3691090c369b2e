// Reasons active at the same time.
#pragma once

#include <cstdint>

#include "server/base/reason.h"

namespace handrail {

// A set of reasons in 64 bits; kNone is in no set. Real-time safe.
class ReasonSet {
 public:
  constexpr ReasonSet() noexcept = default;
  constexpr explicit ReasonSet(std::uint64_t bits) noexcept : bits_(bits) {}

  void add(Reason reason) noexcept { bits_ |= bit(reason); }
  void add(const ReasonSet& others) noexcept { bits_ |= others.bits_; }
  bool has(Reason reason) const noexcept { return (bits_ & bit(reason)) != 0; }
  std::uint64_t bits() const noexcept { return bits_; }
  // Bit i stands for code i; these are the bits that stand for one.
  static constexpr std::uint64_t kBits =
      ((std::uint64_t{1} << (static_cast<int>(Reason::kCount) - 1)) << 1) - 2;

 private:
  static_assert(static_cast<int>(Reason::kCount) <= 64);
  static constexpr std::uint64_t bit(Reason reason) noexcept {
    return reason == Reason::kNone ? 0 : std::uint64_t{1} << static_cast<int>(reason);
  }
  std::uint64_t bits_ = 0;
};

}  // namespace handrail
