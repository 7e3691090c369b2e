// One direction of the link in virtual time.
#pragma once

#include <cstddef>
#include <vector>

#include "server/base/time.h"

namespace handrail {

// Whole states on their way, each arriving `transit` after it was sent. Holds as many as can be in
// flight at once. When one more than that comes, the oldest is overwritten, which no reader misses:
// a newer one has arrived by then. Allocates only when made.
template <typename State>
class Wire {
 public:
  // `transit` >= 0; sends are at least `period` > 0 apart.
  Wire(Nanos transit, Nanos period)
      : transit_(transit), entries_(static_cast<std::size_t>(transit / period) + 2) {}

  void send(const State& state, Nanos now) noexcept {
    Entry& entry = entries_[slot(count_)];
    entry.state = state;
    entry.due = now + transit_;
    if (count_ < entries_.size()) {
      ++count_;
    } else {
      first_ = slot(1);
    }
  }

  // Copies to `newest` the newest state that has arrived by `now` and was not received before; true
  // if there is one.
  bool receive(Nanos now, State& newest) noexcept {
    std::size_t due = 0;
    while (due < count_ && entries_[slot(due)].due <= now) ++due;
    if (due == 0) return false;
    const Entry& entry = entries_[slot(due - 1)];
    newest = entry.state;
    arrived_ = entry.due;
    first_ = slot(due);
    count_ -= due;
    return true;
  }

  // How long ago at `now` the state last received arrived; kForever before the first.
  Nanos age(Nanos now) const noexcept { return arrived_ < 0 ? kForever : now - arrived_; }

  Nanos transit() const noexcept { return transit_; }

 private:
  struct Entry {
    State state;
    Nanos due = 0;
  };
  std::size_t slot(std::size_t i) const noexcept {
    const std::size_t at = first_ + i;
    return at < entries_.size() ? at : at - entries_.size();
  }

  Nanos transit_;
  std::vector<Entry> entries_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Nanos arrived_ = -1;
};

}  // namespace handrail
