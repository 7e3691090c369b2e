// Fixed ring: one producer, one consumer, every element delivered in order or refused.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace handrail {

// Wait-free queue of at most N elements; N a power of two. No allocation after construction.
template <typename T, std::size_t N>
class Ring {
  static_assert(N >= 2 && (N & (N - 1)) == 0, "N must be a power of two");

 public:
  // Producer only. False when the ring is full; nothing is overwritten. Real-time safe.
  bool push(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == N) return false;
    slots_[head & (N - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  // Consumer only. False when empty, leaving `out` alone. Real-time safe.
  bool pop(T& out) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    out = slots_[tail & (N - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, N> slots_{};
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace handrail
