#include "server/master/memory_reserve.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace handrail {

namespace {

std::atomic<void*> kept_back{nullptr};

void hand_out() {
  void* const block = kept_back.exchange(nullptr);
  if (block == nullptr) throw std::bad_alloc();
  std::free(block);
}

}  // namespace

MemoryReserve::MemoryReserve(std::size_t bytes) noexcept : bytes_(bytes) {
  std::set_new_handler(hand_out);
  fill();
}

MemoryReserve::~MemoryReserve() {
  std::set_new_handler(nullptr);
  std::free(kept_back.exchange(nullptr));
}

bool MemoryReserve::is_spent() const noexcept { return kept_back == nullptr; }

bool MemoryReserve::fill() noexcept {
  if (!is_spent()) return true;
  void* const block = std::malloc(bytes_);
  std::free(kept_back.exchange(block));
  return block != nullptr;
}

}  // namespace handrail
