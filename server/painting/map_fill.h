// Connected pieces of a painted map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/model/walls.h"

namespace handrail {

// Takes pieces of pixels that share sides away from a set of them, row by row.
class MapFiller {
 public:
  // `in`: 1 for each pixel of `map` in the set, else 0.
  MapFiller(const CoverageMap& map, std::vector<std::uint8_t> in)
      : width_(static_cast<std::size_t>(map.width)), in_(std::move(in)) {}
  bool has(std::size_t i) const { return in_[i] != 0; }

  // Takes the piece around `start` away; calls `run(first, end)` for each of its runs.
  template <typename Run>
  void take(std::size_t start, const Run& run) {
    waiting_.assign(1, start);
    while (!waiting_.empty()) {
      const std::size_t i = waiting_.back();
      waiting_.pop_back();
      if (in_[i] == 0) continue;
      const std::size_t row = i / width_ * width_;
      std::size_t first = i, end = i + 1;
      while (first > row && in_[first - 1] != 0) --first;
      while (end < row + width_ && in_[end] != 0) ++end;
      for (std::size_t k = first; k < end; ++k) in_[k] = 0;
      run(first, end);
      if (row > 0) wait_for(first - width_, end - width_);
      if (row + width_ < in_.size()) wait_for(first + width_, end + width_);
    }
  }

 private:
  // One pixel of each run that begins in a stretch or reaches into it.
  void wait_for(std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      if (in_[k] != 0 && (k == first || in_[k - 1] == 0)) waiting_.push_back(k);
    }
  }

  std::size_t width_;
  std::vector<std::uint8_t> in_;
  std::vector<std::size_t> waiting_;
};

}  // namespace handrail
