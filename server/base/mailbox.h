// Newest-value mailbox: one writer, one reader, neither ever waits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace handrail {

// Triple buffer. The writer publishes a whole value; the reader takes the newest whole value and
// misses the ones in between. Wait-free, no allocation; T must be copy-assignable without throwing.
template <typename T>
class Mailbox {
 public:
  // Writer only. Real-time safe if copying T is.
  void publish(const T& value) noexcept {
    slots_[back_] = value;
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) &
            kIndex;
  }

  // Reader only. Copies the newest value into `out` and returns true if it is one not taken before;
  // else leaves `out` alone. Real-time safe if copying T is.
  bool take(T& out) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    out = slots_[front_];
    return true;
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  std::array<T, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t back_ = 0;
  alignas(64) std::uint8_t front_ = 2;
};

}  // namespace handrail
