// A counter that begins anew at its end, as a count without end.
#pragma once

#include <cstdint>

namespace handrail {

// Real-time safe.
class EncoderCount {
 public:
  // `max_data`: the counter's largest number, such as 2^24 - 1.
  void begin(unsigned int raw, unsigned int max_data) noexcept {
    last_ = raw;
    size_ = static_cast<std::int64_t>(max_data) + 1;
    count_ = step_ = 0;
  }
  // The count since begin(). Between two readings it goes less than half of the counter's size: the
  // shorter way is the right one.
  std::int64_t next(unsigned int raw) noexcept {
    std::int64_t step = (static_cast<std::int64_t>(raw) - last_) % size_;
    if (step > size_ / 2) step -= size_;
    if (step < -(size_ / 2)) step += size_;
    last_ = raw;
    step_ = step;
    return count_ += step;
  }
  // As next() gave it last.
  std::int64_t count() const noexcept { return count_; }
  // How far it went with the last next().
  std::int64_t step() const noexcept { return step_; }

 private:
  std::int64_t last_ = 0, size_ = 1, count_ = 0, step_ = 0;
};

}  // namespace handrail
