// What a link did of late, as shares of a sliding window.
#pragma once

#include <array>
#include <cstddef>

namespace handrail {

// Each 0 to 1 of the window.
struct LinkShares {
  double held = 0.0;       // of the time: nothing fresh had come here for over 20 ms
  double peer_held = 0.0;  // the same there
  double lost = 0.0;       // of the datagrams to here, the mean over the time
  double peer_lost = 0.0;  // of those to there
  double heard = 0.0;      // how much of the window there is, since it began
};

// Slides by a tenth of its length, with a straight line between. Real-time safe.
class LinkWindow {
 public:
  // Lets `elapsed` [s] pass as `now` says, but for `heard`; the window is the last `span` > 0 [s].
  void add(const LinkShares& now, double elapsed, double span) noexcept;
  LinkShares shares() const noexcept;

 private:
  static constexpr std::size_t kBlocks = 10;

  std::array<LinkShares, kBlocks> blocks_{};  // means of each
  std::size_t oldest_ = 0;
  LinkShares begun_;  // of the present block, as far as it has come; `heard` is how far
};

}  // namespace handrail
