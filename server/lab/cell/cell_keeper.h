// Leaves what a cell's steps were given and what came of it where the daemons leave theirs.
#pragma once

#include <cstdint>

#include "server/record/record_tap.h"

namespace handrail {

// Of the one scene that a cell has, in what is kept of it.
inline constexpr std::uint32_t kCellScene = 1;

// Nothing is kept without taps. Real-time safe.
class CellKeeper {
 public:
  // Not owned; null: none.
  void keep(MasterTap* master, SlaveTap* slave) noexcept {
    master_ = master;
    slave_ = slave;
  }

  // The program begins, perhaps anew, with epochs from there.
  void master_begins(std::uint64_t epochs) noexcept { master_begins_ = epochs; }
  void slave_begins(std::uint64_t epochs) noexcept { slave_begins_ = epochs; }

  void before_tick(Nanos now, const HapticRun& run) noexcept;
  void after_tick(Nanos now, const HapticTick& given, const KeptTiming& timing,
                  const HapticRun& run) noexcept;
  void before_cycle(Nanos now, const FollowState& state, const FollowOutput& out) noexcept;
  // `placed`: the motion was placed there before the step; null: it was not.
  void after_cycle(Nanos now, const JointVector* placed, const FollowInput& given,
                   const KeptTiming& timing, const FollowOutput& out) noexcept;

 private:
  MasterTap* master_ = nullptr;
  SlaveTap* slave_ = nullptr;
  std::uint64_t master_begins_ = 0;  // not 0: with the next tick
  std::uint64_t slave_begins_ = 0;
  KeptTick tick_;
  KeptCycle cycle_;
};

}  // namespace handrail
