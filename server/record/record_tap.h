// Where a real-time thread leaves what it did, for the thread that writes it down.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "server/base/ring.h"
#include "server/base/time.h"
#include "server/follow/follow_step.h"
#include "server/haptic/haptic_run.h"
#include "server/model/handle_force.h"

namespace handrail {

// Between two images of what a step remembers: as far back a replay can begin.
inline constexpr Nanos kImagePeriod = 5 * kSecond;
// What a thread may be behind that writes: a second of ticks.
inline constexpr std::size_t kMostKept = 1024;

// When the other side's newest datagram came, for who compares the clocks of both sides.
struct KeptTiming {
  Nanos received_at = -kForever;  // by the own clock; -kForever: none has come
  Nanos peer_sent = 0;            // by the other side's
  Nanos round_trip = -1;          // without the time that it was held there; -1: not known
};

// One tick of the master: what was given to it and what came of it.
struct KeptTick {
  std::uint64_t number = 0;  // from 1
  Nanos at = 0;
  std::uint32_t scene = 0;  // in force: LoopScene::number
  HapticTick given;
  KeptTiming timing;
  HapticResult came;
  double turned = 0.0;  // of what is progressive among the walls [rad]
  HandleForce handle;   // as measured; of no use to the step
};

// One cycle of the slave.
struct KeptCycle {
  std::uint64_t number = 0;  // from 1
  Nanos at = 0;
  std::uint32_t scene = 0;
  bool placed = false;  // before the step the motion was placed at `place`
  JointVector place = JointVector::Zero();
  FollowInput given;
  KeptTiming timing;
  FollowOutput came;
};

// What a step remembered before the tick or cycle of that number.
template <std::size_t Most>
struct KeptImage {
  std::uint64_t number = 0;
  std::uint32_t scene = 0;
  std::uint64_t begins = 0;  // not 0: nothing yet, but epochs that begin here
  std::size_t size = 0;
  std::array<std::byte, Most> bytes;
};

// One writer, one reader; the writer never waits. What there is no room for is counted, and then
// the next image comes at once. Large: keep it on the heap.
template <typename Entry, std::size_t MostImage>
class RecordTap {
 public:
  using Kept = Entry;
  using Image = KeptImage<MostImage>;

  // The real-time thread's side. Real-time safe; a tick costs a copy of what it keeps.
  bool image_due(Nanos now) const noexcept { return now >= next_image_; }
  // `image`: filled by who calls, in image().
  Image& image() noexcept { return scratch_; }
  void keep_image(Nanos now) noexcept {
    next_image_ = images_.push(scratch_) ? now + kImagePeriod : now;
  }
  // Before the entry of that number, all of the above: where an image is due, or where the program
  // begins, which `begins` then says no more. `save(bytes)` fills them and gives how many.
  template <typename Save>
  void image_before(std::uint64_t number, Nanos now, std::uint32_t scene, std::uint64_t& begins,
                    const Save& save) noexcept {
    if (begins == 0 && !image_due(now)) return;
    scratch_.number = number;
    scratch_.scene = scene;
    scratch_.begins = std::exchange(begins, 0);
    scratch_.size = save(scratch_.bytes);
    keep_image(now);
  }
  void keep(const Entry& entry) noexcept {
    if (entries_.push(entry)) return;
    lost_.fetch_add(1, std::memory_order_relaxed);
    next_image_ = entry.at;
  }

  // The writing thread's side.
  bool take(Entry& out) noexcept { return entries_.pop(out); }
  bool take(Image& out) noexcept { return images_.pop(out); }
  // Entries there was no room for, so far.
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  Ring<Entry, kMostKept> entries_;
  Ring<Image, 4> images_;
  Image scratch_;
  std::atomic<std::uint64_t> lost_{0};
  Nanos next_image_ = -kForever;
};

// What follow_step remembers, as it lies in the memory of this build. It holds no addresses.
inline constexpr std::size_t kMostFollowImage = sizeof(FollowState) + sizeof(FollowOutput);
inline std::size_t save_follow(const FollowState& state, const FollowOutput& out,
                               std::span<std::byte, kMostFollowImage> image) noexcept {
  std::memcpy(image.data(), static_cast<const void*>(&state), sizeof(state));
  std::memcpy(image.data() + sizeof(state), static_cast<const void*>(&out), sizeof(out));
  return kMostFollowImage;
}
// False, and nothing is changed, where the image is not as long as that.
inline bool restore_follow(std::span<const std::byte> image, FollowState& state,
                           FollowOutput& out) noexcept {
  if (image.size() != kMostFollowImage) return false;
  std::memcpy(static_cast<void*>(&state), image.data(), sizeof(state));
  std::memcpy(static_cast<void*>(&out), image.data() + sizeof(state), sizeof(out));
  return true;
}

using MasterTap = RecordTap<KeptTick, HapticRun::kMostImage>;
using SlaveTap = RecordTap<KeptCycle, kMostFollowImage>;

}  // namespace handrail
