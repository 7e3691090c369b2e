// What a program still needs when there is no memory left.
#pragma once

#include <cstddef>

namespace handrail {

// Memory kept back. The first `new` that finds none is given it and goes on; the next one throws,
// until the owner has made room and filled the reserve again. One for the whole process, as its new
// handler is. Filling is for one thread, and none is real-time safe.
class MemoryReserve {
 public:
  // bytes: what is kept back, [1, PTRDIFF_MAX].
  explicit MemoryReserve(std::size_t bytes) noexcept;
  ~MemoryReserve();
  MemoryReserve(const MemoryReserve&) = delete;
  MemoryReserve& operator=(const MemoryReserve&) = delete;

  // Was it handed out?
  bool is_spent() const noexcept;
  // Full again; false when there is too little memory.
  bool fill() noexcept;

 private:
  const std::size_t bytes_;
};

}  // namespace handrail
