#include "server/session/link_window.h"

#include <algorithm>

namespace handrail {
namespace {

LinkShares plus(const LinkShares& a, double factor, const LinkShares& b) {
  return {a.held + factor * b.held, a.peer_held + factor * b.peer_held, a.lost + factor * b.lost,
          a.peer_lost + factor * b.peer_lost, a.heard + factor * b.heard};
}

// What ticks do not quite add up to.
constexpr double kFull = 1.0 - 1e-9;

}  // namespace

void LinkWindow::add(const LinkShares& now, double elapsed, double span) noexcept {
  LinkShares heard = now;
  heard.heard = 1.0;
  double left = static_cast<double>(kBlocks) * std::min(elapsed / span, 1.0);
  while (left > 0.0) {
    const double piece = std::min(left, 1.0 - begun_.heard);
    begun_ = plus(begun_, piece, heard);
    left -= piece;
    if (begun_.heard < kFull) continue;
    blocks_[oldest_] = begun_;
    blocks_[oldest_].heard = 1.0;
    oldest_ = (oldest_ + 1) % kBlocks;
    begun_ = LinkShares();
  }
}

LinkShares LinkWindow::shares() const noexcept {
  LinkShares sum = plus(begun_, -begun_.heard, blocks_[oldest_]);
  for (const LinkShares& block : blocks_) sum = plus(sum, 1.0, block);
  LinkShares mean = plus(LinkShares(), 1.0 / static_cast<double>(kBlocks), sum);
  if (mean.heard > kFull) mean.heard = 1.0;
  return mean;
}

}  // namespace handrail
