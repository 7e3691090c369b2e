// Reasons active at the same time.
#pragma once

#include <bitset>

#include "server/model/reason.h"

namespace handrail {

// kNone is in no set. Real-time safe.
class ReasonSet {
 public:
  void add(Reason reason) noexcept {
    if (reason != Reason::kNone) set_[index(reason)] = true;
  }
  void add(const ReasonSet& others) noexcept { set_ |= others.set_; }
  bool has(Reason reason) const noexcept { return set_[index(reason)]; }

 private:
  static constexpr std::size_t index(Reason reason) noexcept {
    return static_cast<std::size_t>(reason);
  }
  std::bitset<static_cast<std::size_t>(Reason::kCount)> set_;
};

}  // namespace handrail
