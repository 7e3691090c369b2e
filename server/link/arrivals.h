// Which of the last 100 datagrams of a session arrived, by their sequence.
#pragma once

#include <bitset>
#include <cstdint>

#include "server/link/reject.h"

namespace handrail {

// Remembers one session. All methods real-time safe.
class Arrivals {
 public:
  static constexpr std::uint64_t kWindow = 100;

  // Starts a session whose first datagram is `sequence`.
  void restart(std::uint64_t sequence) noexcept;
  // Takes one more arrival: kNone if it is newer than all before, kDuplicate if it is known to have
  // come before, else kStale. A stale one within the window counts as received.
  Reject add(std::uint64_t sequence) noexcept;

  std::uint64_t newest() const noexcept { return newest_; }
  // Received among the last 100 sequences up to the newest, 0 to 100. A young session starts low:
  // quality is earned.
  int received() const noexcept { return static_cast<int>(seen_.count()); }
  // Share lost of the last 100, or of as many as the session has had since restart; 0 to 1.
  double loss_share() const noexcept;

 private:
  std::bitset<kWindow> seen_;  // bit i = sequence newest_ - i
  std::uint64_t first_ = 0;
  std::uint64_t newest_ = 0;
};

}  // namespace handrail
