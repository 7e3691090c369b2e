// One scene after another under the hand: the step, and the walls beside it where a scene has some.
// All of a tick that is neither device, clock nor thread, so that the lab can do it again.
#pragma once

#include <cstddef>
#include <span>

#include "server/haptic/haptic_step.h"
#include "server/haptic/wall_step.h"

namespace handrail {

// What the haptic loop runs while a scene is loaded.
struct LoopScene {
  HapticSettings haptic;
  WallRun* walls = nullptr;  // runs beside the step, with its force in place of an arm's; not owned
  std::uint32_t number = 0;  // of the scenes that this program has loaded
};

// What a tick is given.
struct HapticTick {
  HapticInput in;
  double dt = 0.0;             // since the last [s]
  bool let_go = false;         // the device has let go since the last
  bool ends = false;           // the program is to end: in place of any order
  bool led_by_cursor = false;  // the device's hand, as in HapticCapabilities
};

// What it gives.
struct HapticResult {
  HapticOutput out;
  bool has_walls = false;
  WallOutput walls;  // with has_walls
};

// What HapticRun remembers, besides what the scene's walls do.
struct HapticMemory {
  HapticState state;
  WallInput walls;
  HapticResult result;
};
inline constexpr std::size_t kMostHapticImage =
    sizeof(HapticMemory) + sizeof(WallMemory) + WallProxy::kMostImage;

// Real-time safe; large.
class HapticRun {
 public:
  explicit HapticRun(const LoopScene& scene) noexcept : scene_(scene) {}

  // Before the first tick: as begin_epochs.
  void begin(std::uint64_t unique) noexcept { begin_epochs(unique, memory_.state); }
  // Another scene takes over; to be asked for while the session is off or in fault. The force that
  // is there goes on from one to the other, within their step limits.
  void change(const LoopScene& scene) noexcept;
  bool idle() const noexcept {
    const SessionState session = memory_.state.lead.session;
    return session == SessionState::kOff || session == SessionState::kFault;
  }
  // What comes of it, until the next one.
  const HapticResult& tick(const HapticTick& tick) noexcept;

  const LoopScene& scene() const noexcept { return scene_; }
  const HapticState& state() const noexcept { return memory_.state; }
  const HapticResult& result() const noexcept { return memory_.result; }

  // All that ticks leave behind, as it lies in the memory of this build: with the same scene the
  // same ticks lead on from it to the same results, bit for bit. It holds no addresses.
  static constexpr std::size_t kMostImage = kMostHapticImage;
  // Returns how much of `out` it took, of kMostImage bytes at least.
  std::size_t save(std::span<std::byte> out) const noexcept;
  // False, and nothing is changed, where it is not as long as this scene's would be.
  bool restore(std::span<const std::byte> image) noexcept;

 private:
  void let_go() noexcept;
  // The force of the scene's walls in place of an arm's.
  void feel_walls(const HapticTick& tick, const HapticInput& in) noexcept;

  LoopScene scene_;
  HapticMemory memory_;
  HapticInput in_;
};

}  // namespace handrail
