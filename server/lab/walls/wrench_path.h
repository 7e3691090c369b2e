// The wrench's loop, and the guiding ball that leads around it.
#pragma once

#include "server/base/plane.h"
#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

inline constexpr double kLoopTime = 6.0;  // the ball's, both aisles [s]

// Along the middle of the semi-circular aisle the way that tightens, and straight back. Frame of
// the walls.
class WrenchPath {
 public:
  // From the drawn arc of the scene whose region is progressive. The error says what is missing.
  static Result<WrenchPath> of(const Scene& scene);

  const Vec2& centre() const noexcept { return centre_; }         // of the arc [m]
  double radius() const noexcept { return radius_; }              // of the arc's middle line [m]
  double width() const noexcept { return width_; }                // of its aisle [m]
  double length() const noexcept { return turn_ + chord_; }       // of the loop [m]
  double turn_length() const noexcept { return turn_; }           // of the arc alone [m]
  double speed() const noexcept { return length() / kLoopTime; }  // of the ball [m/s]
  // Where the two aisles meet: where the turn begins, and where it ends [m].
  Vec2 begin() const { return at(0.0); }
  Vec2 end() const { return at(turn_); }
  // The middle of the smallest box around the loop's middle line [m].
  Vec2 middle() const;

  // The point `s` from the turn's beginning, in the tightening way, any s [m].
  Vec2 at(double s) const;
  // Unit, the tightening way.
  Vec2 tangent(double s) const;

 private:
  Vec2 centre_ = Vec2::Zero();
  double radius_ = 0.0, width_ = 0.0;
  double from_ = 0.0, sweep_ = 0.0;  // angle where the turn begins; turned, counter-clockwise [rad]
  double turn_ = 0.0, chord_ = 0.0;  // lengths [m]
};

// The ball: from the middle of the straight aisle to where the turn begins, `turns` loops the
// tightening way, `loosen` loops back, at constant speed. Who falls behind is led along the aisle,
// not across the wall: the ball then waits at most kBallAhead in front.
inline constexpr double kBallAhead = 0.040;  // [m]

class GuidingBall {
 public:
  GuidingBall(const WrenchPath& path, int turns, int loosen) noexcept;

  double duration() const noexcept;  // [s]
  // The loop under way at `t`, from 0; -1 before the first.
  int loop(double t) const noexcept;
  // Lets the ball, as the hand sees it, move to where it is at `t`. To be called in the order of
  // time.
  void move(double t, const Vec2& hand) noexcept;
  const Vec2& p() const noexcept { return p_; }  // [m]
  const Vec2& v() const noexcept { return v_; }  // [m/s]
  // Way that the hand has yet to make to the end [m].
  double left() const noexcept { return path_.length() * (turns_ + loosen_) - behind_; }

 private:
  // Way of the ball along the loops, back and forth [m].
  double travelled(double t) const noexcept;
  double along(double travelled) const noexcept;  // for WrenchPath::at
  double direction(double travelled) const noexcept;

  WrenchPath path_;
  int turns_, loosen_;
  double lead_in_;  // [m]
  double behind_;   // way the hand has made, as travelled() [m]
  Vec2 p_ = Vec2::Zero();
  Vec2 v_ = Vec2::Zero();
};

}  // namespace handrail
