// Judges of a hand among walls: what the walls let in, what they gave back, where the hand was.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "server/haptic/wall_proxies.h"
#include "server/lab/walls/wall_bench.h"

namespace handrail {

// How deep contacts went, against what energy allows a spring wall:
//
//   F/K + sqrt((F/K)^2 + m v^2/K) + v T
//
// for a mass m that meets the wall at speed v and is pushed on by F: here the most that the hand's
// muscles and the scene's other effects pushed into the wall so far in the contact, and the most
// speed into the wall from a tick before it on.
class PenetrationWatch {
 public:
  // m of device and hand [kg].
  PenetrationWatch(const Walls& walls, double mass) noexcept : walls_(&walls), mass_(mass) {}
  void see(const WallTick& tick) noexcept;

  double deepest() const noexcept { return deepest_; }  // [m]
  // Depth as a share of the bound, the largest of all contacts at least kShallow deep.
  double share_of_bound() const noexcept { return share_; }
  // Shallower contacts are about the device's counts, not about walls.
  static constexpr double kShallow = 0.2e-3;  // [m]

 private:
  const Walls* walls_;
  double mass_;
  double push_ = 0.0, speed_ = 0.0;  // into the wall, this contact
  Vec2 velocity_ = Vec2::Zero();     // a tick before
  bool touching_ = false;
  double deepest_ = 0.0, share_ = 0.0;
};

// Whether walls give more where aisles meet than elsewhere: the largest force of the walls while
// the hand passes a junction, over the largest local wall force of the same passage. The local wall
// force is what the wall would give the same motion of the hand far from any junction, by (2.1)
// with the wall's own K and B:
//
//   K (d + c) + B v
//
// with d the hand's distance from the nearest free point, found afresh each tick and not from where
// the proxy was; c the one count of the encoders by which a reading may be deeper than the truth;
// and v the hand's speed toward the wall, the larger of this tick's and the last one's.
class JunctionWatch {
 public:
  // Within `reach` of one of `places` the hand is at a junction.
  JunctionWatch(const Walls& walls, std::vector<Vec2> places, double reach)
      : walls_(&walls),
        nearest_(make_wall_proxy(walls)),
        places_(std::move(places)),
        reach_(reach) {}
  void see(const WallTick& tick) noexcept;

  // The largest of all passages in which the wall gave kFaint or more; 0 without one.
  double ratio() const noexcept { return std::max(ratio_, passage()); }
  static constexpr double kFaint = 1.0;  // [N]

 private:
  double passage() const noexcept { return force_ >= kFaint ? force_ / local_ : 0.0; }
  double local_force(const WallTick& tick) noexcept;

  const Walls* walls_;
  std::unique_ptr<WallProxy> nearest_;
  std::vector<Vec2> places_;
  double reach_;
  Vec2 velocity_ = Vec2::Zero();  // a tick before
  int at_ = -1;
  double force_ = 0.0, local_ = 1.0;  // of this passage [N]
  double ratio_ = 0.0;
};

// Whether the hand rests: it has stayed within 2 mm for half a second.
class RestWatch {
 public:
  void see(const WallTick& tick) noexcept;
  bool rests() const noexcept { return rests_; }

 private:
  Vec2 anchor_ = Vec2::Zero();
  double since_ = 0.0;  // [s]
  bool rests_ = false;
};

// How much of the hand's way was inside the aisles, and the largest force on the handle.
class GuidanceWatch {
 public:
  void see(const WallTick& tick) noexcept;
  double inside_share() const noexcept { return way_ > 0.0 ? inside_ / way_ : 1.0; }
  double most_force() const noexcept { return most_force_; }  // [N]

 private:
  Vec2 last_ = Vec2::Zero();
  bool seen_ = false;
  double way_ = 0.0, inside_ = 0.0;  // [m]
  double most_force_ = 0.0;
};

}  // namespace handrail
