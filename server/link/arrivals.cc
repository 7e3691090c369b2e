#include "server/link/arrivals.h"

#include <algorithm>

namespace handrail {

void Arrivals::restart(std::uint64_t sequence) noexcept {
  *this = Arrivals();
  seen_.set(0);
  first_ = newest_ = sequence;
  spell_ = sequence / kSpell;
}

Reject Arrivals::add(std::uint64_t sequence) noexcept {
  if (sequence > newest_) {
    const std::uint64_t step = sequence - newest_;
    if (step < kBits) {
      seen_ <<= step;
    } else {
      seen_.reset();
    }
    seen_.set(0);
    newest_ = sequence;
    if (const std::uint64_t spell = newest_ / kSpell; spell != spell_) {
      latest_ = {0, spell == spell_ + 1 ? latest_[0] : 0};
      spell_ = spell;
    }
    return Reject::kNone;
  }
  const std::uint64_t back = newest_ - sequence;
  if (back >= kBits || sequence < first_) return Reject::kStale;
  if (seen_.test(back)) return Reject::kDuplicate;
  if (back > kLatest) return Reject::kStale;
  seen_.set(back);
  latest_[0] = std::max(latest_[0], back);
  return Reject::kStale;
}

std::uint64_t Arrivals::under_way() const noexcept {
  const std::uint64_t latest = std::max(latest_[0], latest_[1]);
  return latest == 0 ? 0 : latest + 1;
}

int Arrivals::received() const noexcept {
  return static_cast<int>(((seen_ >> under_way()) << (kBits - kWindow)).count());
}

double Arrivals::loss_share() const noexcept {
  const std::uint64_t since = newest_ - first_;
  if (newest_ == 0 || since < under_way()) return 0.0;
  const std::uint64_t expected = std::min(since - under_way(), kWindow - 1) + 1;
  return 1.0 - static_cast<double>(received()) / static_cast<double>(expected);
}

}  // namespace handrail
