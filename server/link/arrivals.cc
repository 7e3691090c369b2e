#include "server/link/arrivals.h"

#include <algorithm>

namespace handrail {

void Arrivals::restart(std::uint64_t sequence) noexcept {
  seen_.reset();
  seen_.set(0);
  first_ = newest_ = sequence;
}

Reject Arrivals::add(std::uint64_t sequence) noexcept {
  if (sequence > newest_) {
    const std::uint64_t step = sequence - newest_;
    if (step < kWindow) {
      seen_ <<= step;
    } else {
      seen_.reset();
    }
    seen_.set(0);
    newest_ = sequence;
    return Reject::kNone;
  }
  const std::uint64_t back = newest_ - sequence;
  if (back >= kWindow || sequence < first_) return Reject::kStale;
  if (seen_.test(back)) return Reject::kDuplicate;
  seen_.set(back);
  return Reject::kStale;
}

double Arrivals::loss_share() const noexcept {
  if (newest_ == 0) return 0.0;
  const std::uint64_t expected = std::min(newest_ - first_, kWindow - 1) + 1;
  return 1.0 - static_cast<double>(received()) / static_cast<double>(expected);
}

}  // namespace handrail
