// The judge of the targets that a robot controller accepts, at the controller's own clock.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/joints.h"
#include "server/base/time.h"

namespace handrail {

// One accepted target. Each number is the largest of any joint as a share of its limit, without
// what float32 rounding explains: above 1 is a breach.
struct TargetVerdict {
  double step = 0.0;   // from where the controller held the arm, of a cycle at full speed
  double speed = 0.0;  // divided differences of the accepted targets by their times
  double acceleration = 0.0;
  double jerk = 0.0;
  std::int8_t joint = -1;  // 0..5: whose share is the largest
  bool from_rest = false;  // read as the first step from a standing arm

  double worst() const noexcept;
  bool fine() const noexcept;
  // Takes over what is larger in `other`.
  void raise_to(const TargetVerdict& other) noexcept;
};

// Knows times and targets, nothing else. A controller holds its last target in every cycle that
// brings it no other, and that time counts: over a gap the differences are divided by the time that
// passed. A target is fine when it lies at most one cycle at full speed from where the arm is held,
// and the targets up to it are those of
//   (a) a motion that goes on through the gaps, within speed, acceleration and jerk, or
//   (b) a motion that ended in a gap, and another from rest where the arm is held, which may have
//       been planned since any cycle of the gap: its first targets were lost.
// What can be read as either stays open until later targets tell; the reading with the fewest halts
// counts. A halt is a motion that ended in a gap without braking: no breach of the target that
// follows, but listed. A hold that is longer than any joint needs to stop ends (a).
//
// A target equal to the one held moves nothing and only prolongs the hold. Pure; all calls are
// real-time safe.
class ControllerAudit {
 public:
  // No plan goes on for longer without an answer: 14 cycles, 0.1 s.
  static constexpr int kMostLost = 14;  // [cycles]: what CommandTrain holds unconfirmed

  // `limits` > 0: of the controller's joints. `period` > 0: of its cycle.
  ControllerAudit(const JointLimits& limits, Nanos period) noexcept;

  // The arm stands at `q` [rad], finite; forgets any motion. Until then the first target places it.
  void place(const JointVector& q) noexcept;

  // The controller took `q` [rad], finite, for its target at `at`, later than any target before.
  // `lost`: for so many cycles, where that is known, targets that did not reach it were sent, or
  // their time passed unseen.
  TargetVerdict accepted(Nanos at, const JointVector& q, int lost = kMostLost) noexcept;

  // The target to come was sent for the cycle before and came after it: the arm was held by the
  // controller, not by whoever sends. What follows is judged as if that cycle had not passed.
  void came_late() noexcept;

  // No target came until `now`.
  void until(Nanos now) noexcept;

  std::uint64_t targets() const noexcept { return targets_; }
  std::uint64_t breaches() const noexcept { return breaches_; }  // targets that were not fine
  // The largest of each number, over all targets.
  const TargetVerdict& worst() const noexcept { return worst_; }
  // Motions that ended without braking, and the hardest of those ends: last speed / cycle, as a
  // share of the acceleration limit.
  std::uint64_t halts() const noexcept;
  double hardest_halt() const noexcept;
  // Cycles in which a moving arm was held for want of a target.
  std::uint64_t held() const noexcept { return held_; }

 private:
  struct Point {
    Nanos at = 0;
    JointVector q = JointVector::Zero();
  };
  static constexpr std::size_t kKnown = 3;  // targets that a third difference needs beside the new
  using History = std::array<Point, kKnown>;

  // One way to understand the targets so far.
  struct Reading {
    bool open = false;
    // The arm stood last at `rest_until`, or whole cycles earlier, but not before `rest_from`.
    Nanos rest_until = 0;
    Nanos rest_from = 0;
    std::uint64_t halts = 0;
    double hardest = 0.0;
  };
  static const Reading& kinder(const Reading& a, const Reading& b) noexcept;

  History rest_until(Nanos at, const JointVector& q) const noexcept;
  History history(int since, Nanos rest) const noexcept;
  TargetVerdict go_on(const Point& next, int since, Reading& reading) const noexcept;
  TargetVerdict judge(const Point& next, const History& before) const noexcept;
  Reading ended(std::size_t reading) const noexcept;
  Reading at_rest() const noexcept;
  Reading best() const noexcept;
  bool moving() const noexcept;
  void settle(Nanos now) noexcept;

  JointLimits limits_;
  Nanos period_;
  Nanos longest_stop_;
  bool placed_ = false;
  bool standing_ = false;  // the arm is at rest at points_[0], as rest_ tells
  History points_;         // the newest targets, newest first
  Reading rest_;
  // [i]: the arm was at rest before points_[i]; the last one: before any point known.
  std::array<Reading, kKnown> readings_{};
  std::uint64_t targets_ = 0;
  std::uint64_t breaches_ = 0;
  std::uint64_t held_ = 0;
  TargetVerdict worst_;
};

}  // namespace handrail
