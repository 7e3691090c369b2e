// Datagrams as they came and went, left by the thread that has them for the one that writes them
// down.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/base/ring.h"
#include "server/base/time.h"

namespace handrail {

enum class PacketWay : std::uint8_t {
  kLinkIn,    // from the other daemon, taken out of its encryption
  kLinkOut,   // to it, before it is encrypted
  kRobotIn,   // from the arm's controller
  kRobotOut,  // to it
  kSensorIn,  // from the force sensor
  kSensorOut  // to it
};

// The longest that the link sends; the controller's and the sensor's are shorter.
inline constexpr std::size_t kMostPacket = 578;

struct KeptPacket {
  Nanos at = 0;  // taken out of its socket, or given to it
  PacketWay way = PacketWay::kLinkIn;
  std::uint16_t size = 0;  // as it came; of a longer one than kMostPacket the rest is not kept
  std::array<std::uint8_t, kMostPacket> bytes;

  std::span<const std::uint8_t> kept() const noexcept {
    return std::span(bytes).first(std::min<std::size_t>(size, kMostPacket));
  }
};

// One writer, one reader; the writer never waits. What there is no room for is counted. Large: keep
// it on the heap.
class PacketTap {
 public:
  // The writer's thread. Real-time safe, two copies of the packet.
  void keep(PacketWay way, Nanos at, std::span<const std::uint8_t> packet) noexcept {
    scratch_.at = at;
    scratch_.way = way;
    scratch_.size = static_cast<std::uint16_t>(std::min<std::size_t>(packet.size(), UINT16_MAX));
    std::copy_n(packet.begin(), scratch_.kept().size(), scratch_.bytes.begin());
    if (!packets_.push(scratch_)) lost_.fetch_add(1, std::memory_order_relaxed);
  }

  // The reader's.
  bool take(KeptPacket& out) noexcept { return packets_.pop(out); }
  // Packets there was no room for, so far.
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

  // A second of the link both ways and of a sensor of 2 kHz; half of one of ATI's 7 kHz.
  static constexpr std::size_t kRoom = 4096;

 private:
  Ring<KeptPacket, kRoom> packets_;
  KeptPacket scratch_;
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace handrail
