// A simulated hand that leads the page's cursor among walls, as those of the lab hold a joystick.
// Simulated: results obtained with it must be labelled so.
#pragma once

#include <cstdint>

#include "devices/hand/hand_pursuit.h"
#include "server/base/time.h"
#include "server/lab/walls/joystick_people.h"
#include "server/lab/walls/wall_bench.h"

namespace handrail {

class WallHand {
 public:
  WallHand(const JoystickPerson& person, const Pose2& walls);

  // Lets the time pass until `now`, any clock: the hand follows what is at `p` with velocity `v`,
  // or lets the lever go; `seen` is where the lever is. Frame of the walls.
  void live(Nanos now, const WallTick& seen, const Vec2& p, const Vec2& v, bool lets_go);

  // Where it leads the cursor to, frame M.
  Pose pose() const;
  double pace() const noexcept { return pace_; }

 private:
  HandModel hand_;
  HandPursuit pursuit_;
  Pose2 walls_;  // in M
  double pace_;
  VectorMotion lever_;  // seen, frame M
  bool follows_ = false;
  Nanos last_ = -1;
};

}  // namespace handrail
