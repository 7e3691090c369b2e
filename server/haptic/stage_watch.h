// Which stage of a scene's walls is in force: the one ordered last, or one that the task's progress
// has led to since (dissertation 2.2.2, step 4).
#pragma once

#include <cstdint>

#include "server/model/walls.h"

namespace handrail {

// What the conditions of stages look at.
struct StageSigns {
  std::uint8_t region = 0;  // that the hand's place is in
  double turned = 0.0;      // of progressive friction; 0 where there is none [rad]
  int place = -1;           // of the detent that holds the hand; -1: none
};

// Real-time safe throughout.
class StageWatch {
 public:
  // The stage now in force, `ordered` being the one asked for and `orders` the count of orders; -1
  // before the first call. An order is followed at once. What a condition asks for is followed 0.1
  // s after the last change of stage at the soonest, so that a change has ended before the next.
  int now(const Walls& walls, int ordered, std::uint32_t orders, double dt) noexcept;
  // What the hand has come to. A stage is asked for where its condition is true and was not; of
  // several the last one listed.
  void see(const Walls& walls, const StageSigns& signs) noexcept;

  int stage() const noexcept { return stage_; }

 private:
  int stage_ = -1;
  int ordered_ = -1;
  std::uint32_t orders_ = 0;
  int led_to_ = -1;         // by a condition, to be followed
  double settled_ = 0.0;    // since the last change [s]
  std::uint64_t true_ = 0;  // whose conditions are: a bit a stage
};

}  // namespace handrail
