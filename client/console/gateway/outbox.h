// Frames that wait for one page, bounded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "client/console/gateway/web.h"

namespace handrail {

// In the order they came; where a newer frame of a slot comes, the oldest one that still waits is
// left out: a page that reads slowly misses some and is told the newest.
class Outbox {
 public:
  // A page that lets more wait is let go: it does not read what it has to know.
  static constexpr std::size_t kMostWaiting = 256;
  static constexpr std::size_t kMostBytes = 4u << 20;

  struct Item {
    SharedText frame;
    bool binary = false;
    FrameWorth worth = {};
  };

  // False: too much waits, and the frame is not taken.
  bool put(Item item) {
    if (const auto old = to_be_left_out(item.worth); old != items_.end()) {
      ++missed_;
      bytes_ -= old->frame->size();
      // The only one of its slot keeps its place in the line.
      if (item.worth.most <= 1) {
        bytes_ += item.frame->size();
        *old = std::move(item);
        return bytes_ <= kMostBytes;
      }
      items_.erase(old);
    }
    if (items_.size() >= kMostWaiting || bytes_ + item.frame->size() > kMostBytes) return false;
    bytes_ += item.frame->size();
    items_.push_back(std::move(item));
    return true;
  }
  std::optional<Item> next() {
    if (items_.empty()) return std::nullopt;
    Item out = std::move(items_.front());
    items_.pop_front();
    bytes_ -= out.frame->size();
    return out;
  }
  std::size_t bytes() const noexcept { return bytes_; }
  std::size_t missed() const noexcept { return missed_; }  // frames left out so far

 private:
  // The oldest of a slot of which as many wait as may.
  std::deque<Item>::iterator to_be_left_out(const FrameWorth& worth) {
    if (worth.slot < 0) return items_.end();
    const auto same = [&](const Item& waits) { return waits.worth.slot == worth.slot; };
    const auto count = std::count_if(items_.begin(), items_.end(), same);
    if (static_cast<std::size_t>(count) < worth.most) return items_.end();
    return std::find_if(items_.begin(), items_.end(), same);
  }

  std::deque<Item> items_;
  std::size_t bytes_ = 0, missed_ = 0;
};

}  // namespace handrail
