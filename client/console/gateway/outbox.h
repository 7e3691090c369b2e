// Frames that wait for one page, bounded.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "client/console/gateway/web.h"

namespace handrail {

// In the order they came; where a newer frame of a slot comes, the older one that still waits is
// left out: a page that reads slowly misses some and is told the newest.
class Outbox {
 public:
  // A page that lets more wait is let go: it does not read what it has to know.
  static constexpr std::size_t kMostWaiting = 256;
  static constexpr std::size_t kMostBytes = 4u << 20;

  struct Item {
    SharedText frame;
    bool binary = false;
    int slot = -1;
  };

  // False: too much waits, and the frame is not taken.
  bool put(Item item) {
    if (item.slot >= 0) {
      for (Item& waits : items_) {
        if (waits.slot != item.slot) continue;
        bytes_ += item.frame->size() - waits.frame->size();
        waits = std::move(item);
        ++missed_;
        return bytes_ <= kMostBytes;
      }
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
  std::deque<Item> items_;
  std::size_t bytes_ = 0, missed_ = 0;
};

}  // namespace handrail
