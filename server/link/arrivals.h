// Which of the last datagrams of a session arrived, by their sequence.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>

#include "server/link/reject.h"

namespace handrail {

// Remembers one session. What came behind a newer datagram has come; what may still come behind one
// is not judged yet. How far behind they come is what the last thousand sequences have shown, so a
// way that keeps its order is judged at once. All methods real-time safe.
class Arrivals {
 public:
  static constexpr std::uint64_t kWindow = 100;  // judged at a time
  // Behind the newest by more than this nothing is waited for. At a datagram a millisecond it is
  // 200 ms, after which a link counts as lost.
  static constexpr std::uint64_t kLatest = 200;

  // Starts a session whose first datagram is `sequence`.
  void restart(std::uint64_t sequence) noexcept;
  // Takes one more arrival: kNone if it is newer than all before, kDuplicate if it is known to have
  // come before, else kStale. A stale one counts as received if it is behind by kLatest at most.
  Reject add(std::uint64_t sequence) noexcept;

  std::uint64_t newest() const noexcept { return newest_; }
  // How many of the newest sequences are not judged yet: up to the one as far behind the newest as
  // one has lately come. 0 where they keep their order.
  std::uint64_t under_way() const noexcept;
  // Received among the kWindow sequences before those, 0 to 100. A young session starts low:
  // quality is earned.
  int received() const noexcept;
  // Share lost of these, or of as many as the session has had since restart; 0 to 1.
  double loss_share() const noexcept;

 private:
  static constexpr std::uint64_t kBits = kWindow + kLatest + 1;
  static constexpr std::uint64_t kSpell = 500;  // `latest_` covers the last one to two of them

  std::bitset<kBits> seen_;                // bit i = sequence newest_ - i
  std::array<std::uint64_t, 2> latest_{};  // behind the newest at arrival: this spell, the last
  std::uint64_t spell_ = 0;                // of newest_: newest_ / kSpell
  std::uint64_t first_ = 0;
  std::uint64_t newest_ = 0;
};

}  // namespace handrail
