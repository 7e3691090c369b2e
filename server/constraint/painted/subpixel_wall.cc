#include "server/constraint/painted/subpixel_wall.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "server/constraint/painted/subpixel_field.h"
#include "server/constraint/proxy_image.h"

namespace handrail {
namespace {

// All lengths in pixels. In brackets: the range in which the tests hold, see WALLS.md.
constexpr int kMaxWork = 192;        // [125, 211] probes a tick; the next carries on
constexpr double kAtRest = 1e-3;     // [5e-5, 0.005] the hand's foot is this near
constexpr double kOnSurface = 1e-3;  // [0, 0.02] distance counts as zero
constexpr double kLongSlide = 5.0;   // [1, any] along a surface in one step
constexpr double kShortSlide = 0.5;  // [0.4, 0.625] ... where walls may be one pixel thin
constexpr double kRound = 0.7;       // [0.231, 3.5] ... nor turning further [rad]
constexpr double kCentre = 0.05;  // [0, 0.25] of its radius from a bend's centre any way is nearer
constexpr double kMiss = 0.3;     // [0.099, 1.5] a slide that ends further off is halved
constexpr double kTurn = 0.5;     // [0, 0.75] ... and one that turns the normal further (cosine)
constexpr double kLongStride = 1.0;    // [0.05, 5] through free space, at least
constexpr double kShortStride = 0.25;  // [0.163, 0.375] ... where walls may be one pixel thin
constexpr double kTrust = 0.9;         // [0, 0.99] of a distance is free, but for
constexpr double kTrustLess = 0.1;     // [0, 10] ... this
constexpr double kInnerCorner = 0.2;   // [0.13, 0.6] an inner corner bends more [1/pixel]
constexpr double kOff = 0.1;           // [0.005, 2] off the surface before it is tried
constexpr double kHop = 2.0;           // [0.4, 3] out of it
constexpr double kAside = 0.8;         // [0.4, any] ... and to the sides, twice [rad]
constexpr double kGain = 0.1;          // [0.005, 0.11] what makes leaving it worth while
constexpr int kSearch = 50;            // [16, 75] for free space around a hand inside a wall

class SubpixelWall final : public WallProxy {
 public:
  explicit SubpixelWall(const Walls& walls)
      : walls_(walls), map_(*walls.map), half_(0.5 * map_.width, 0.5 * map_.height) {
    for (const WallStage& stage : walls.stages) build(gone_of(stage));
    if (fields_.empty()) build(0);
    for (std::size_t i = walls.regions.size(); i-- > 0;) {
      if (walls.regions[i].kind == RegionKind::kWall) border_ = static_cast<std::uint8_t>(i);
    }
    start(walls.start);
  }

  Vec2 start(const Vec2& hand) noexcept override {
    hand_ = to_pixels(hand.allFinite() ? hand : walls_.start);
    place(hand_);
    return to_map(p_);
  }

  WallContact advance(const Vec2& hand) noexcept override {
    const Vec2 last = hand_;
    if (hand.allFinite()) hand_ = to_pixels(hand);
    const double before = (hand_ - p_).norm();
    work_ = 0;
    bool arrived = touching_ && hand_ == held_;
    while (!arrived && work_ < kMaxWork) {
      arrived = touching_ ? slide() : travel();
      if (arrived && touching_) arrived = !let_go() && !escape();
    }
    // A tick's whole work that leads no nearer to a waiting hand goes round in a corner.
    if (!arrived && touching_ && hand_ == last && (hand_ - p_).norm() > before - kAtRest) {
      arrived = true;
      held_ = hand_;
    }
    WallContact out;
    out.proxy = to_map(p_);
    out.normal = touching_ ? n_ : Vec2::Zero();
    out.touching = touching_;
    out.region = region_at_proxy();
    out.wall = touching_ ? wall_at_proxy() : std::uint8_t{0};
    out.work = work_;
    out.unfinished = !arrived;
    return out;
  }

  void set_gone(std::uint64_t gone) noexcept override {
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (fields_[i].gone != gone || i == field_) continue;
      field_ = i;
      return place(p_);
    }
  }

  std::size_t save(std::span<std::byte, kMostImage> out) const noexcept override {
    return put_in_image(out, field_, hand_, held_, stuck_, p_, touching_, clearance_, stride_, n_,
                        bend_, fine_, limit_);
  }
  bool restore(std::span<const std::byte> image) noexcept override {
    const bool taken = take_from_image(image, field_, hand_, held_, stuck_, p_, touching_,
                                       clearance_, stride_, n_, bend_, fine_, limit_);
    field_ = std::min(field_, fields_.size() - 1);
    return taken;
  }

  std::size_t memory() const noexcept override {
    std::size_t sum = sizeof(*this) + fields_.capacity() * sizeof(Field);
    for (const Field& f : fields_) sum += f.distance.memory() - sizeof(SubpixelField);
    return sum;
  }

 private:
  struct Field {
    std::uint64_t gone;
    SubpixelField distance;
  };
  struct Rest {
    Vec2 p, n;
    double bend, limit;
  };
  using Probe = SubpixelField::Probe;

  void build(std::uint64_t gone) {
    for (const Field& f : fields_) {
      if (f.gone == gone) return;
    }
    fields_.push_back({gone, SubpixelField(map_, gone)});
  }

  Vec2 to_pixels(const Vec2& p) const noexcept { return p / map_.pixel + half_; }
  Vec2 to_map(const Vec2& p) const noexcept { return (p - half_) * map_.pixel; }

  Probe probe(const Vec2& p) noexcept {
    ++work_;
    return fields_[field_].distance.at(p);
  }

  // Straight toward the hand, up to the first wall. True when there.
  bool travel() noexcept {
    const Vec2 way = hand_ - p_;
    double left = way.norm();
    if (left <= clearance_) {
      p_ = hand_;
      clearance_ -= left;
      return true;
    }
    const Vec2 u = way / left;
    while (work_ < kMaxWork) {
      const double step = std::min(std::max(clearance_, stride_), left);
      const Vec2 q = step == left ? hand_ : Vec2(p_ + step * u);
      const Probe at = probe(q);
      if (at.distance < 0.0) return land(q, at), false;
      p_ = q;
      left -= step;
      trust(at);
      if (!(left > 0.0)) return true;
    }
    return false;
  }

  // How far the proxy may go unseen from a probe in free space.
  void trust(const Probe& at) noexcept {
    clearance_ = std::max(kTrust * at.distance - kTrustLess, 0.0);
    stride_ = at.fine ? kShortStride : kLongStride;
  }

  // Onto the surface between the free proxy and the wall at `q`.
  void land(Vec2 q, Probe at) noexcept {
    Vec2 free = p_;
    for (int i = 0; i < 12 && at.distance < -kMiss; ++i) {
      const Vec2 middle = 0.5 * (free + q);
      const Probe there = probe(middle);
      if (there.distance >= 0.0) {
        free = middle;
      } else {
        q = middle;
        at = there;
      }
    }
    if (!settle(q, at)) q = p_;  // no surface in reach: stay where it is free
    p_ = q;
    limit_ = kLongSlide;
    touching_ = at.gradient.squaredNorm() > 1e-6;
    clearance_ = 0.0;
    if (touching_) hold(at);
  }

  // Moves `q` along the normal onto the surface; `at`: probed there, and again after. False when it
  // is further off than a step may miss.
  bool settle(Vec2& q, Probe& at) noexcept {
    double moved = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double g2 = at.gradient.squaredNorm();
      if (g2 < 1e-6) return false;
      const double off = at.distance / std::sqrt(g2);
      moved += std::abs(off);
      if (moved > 1.5 * kMiss) return false;
      q -= at.distance / g2 * at.gradient;
      // The distance is as good as linear this near.
      if (std::abs(off) < 0.02) return true;
      at = probe(q);
      if (std::abs(at.distance) < kOnSurface) return true;
    }
    return false;
  }

  void hold(const Probe& at) noexcept {
    n_ = at.gradient.normalized();
    bend_ = at.bend;
    stride_ = at.fine ? kShortStride : kLongStride;
    fine_ = at.fine;
  }

  // Where a slide leads to: so far along the tangent and off it, toward a hand `depth` behind the
  // surface and `s` along. False when the proxy is there.
  bool foot(double depth, double s, double& along, double& drop) const noexcept {
    // The foot of the hand on the circle of curvature `bend_`; none when the hand is beyond its
    // centre, where any way round is nearer.
    const double left = 1.0 - bend_ * depth;
    // Round a tip no further than the surface is known to bend there.
    const double longest = std::min(
        {limit_, fine_ ? kShortSlide : kLongSlide, kRound / std::max(std::abs(bend_), 1e-9)});
    if (left > kCentre) {
      const double g = std::sqrt(left * left + bend_ * bend_ * s * s);
      along = s / g;
      drop = bend_ * s * along / (left + g);
      if (std::abs(along) < kAtRest) return false;
    } else if (std::abs(s) < kAtRest) {
      return false;
    }
    if (!(left > kCentre) || std::abs(along) > longest) {
      along = std::copysign(longest, s);
      drop = 0.5 * bend_ * along * along;
    }
    return true;
  }

  // One step along the surface toward the hand. True when at rest.
  bool slide() noexcept {
    const Vec2 e = hand_ - p_;
    const double depth = -e.dot(n_);
    if (depth < 0.0) {
      touching_ = false;
      clearance_ = 0.0;
      return false;
    }
    const Vec2 t(-n_.y(), n_.x());
    double along = 0.0, drop = 0.0;
    if (!foot(depth, e.dot(t), along, drop)) return true;
    Vec2 q = p_ + along * t - drop * n_;
    Probe at = probe(q);
    // A step that ends on a face turned away may have gone through the wall, not round it.
    const bool found = std::abs(at.distance) <= kMiss && settle(q, at) &&
                       at.gradient.dot(n_) > kTurn * at.gradient.norm();
    if (!found || !((hand_ - q).squaredNorm() < e.squaredNorm())) {
      limit_ = 0.5 * std::abs(along);
      if (limit_ > kAtRest) return false;
      limit_ = kLongSlide;
      return true;
    }
    p_ = q;
    limit_ = std::min(2.0 * limit_, kLongSlide);
    hold(at);
    return false;
  }

  // At rest where the normal turns within a hundredth of a pixel, as in a notch that pixels make in
  // a tip, the normal may point anywhere. Nothing holds the proxy if the way to the hand begins
  // free. True if so.
  bool let_go() noexcept {
    if (!fine_) return false;
    const Vec2 e = hand_ - p_;
    const double far = e.norm();
    if (far <= kOff) return false;
    const Vec2 ahead = p_ + kOff / far * e;
    if (!(probe(ahead).distance > kOnSurface)) return false;
    p_ = ahead;
    touching_ = false;
    clearance_ = 0.0;
    return true;
  }

  // The pixels of an inner corner can hold a proxy that the corner itself would not. At rest in a
  // tight one, tries from a little way out whether the hand can be come nearer to. True if so.
  bool escape() noexcept {
    if (!fine_ || bend_ > -kInnerCorner || hand_ == stuck_) return false;
    const Rest rest{p_, n_, bend_, limit_};
    const double nearest = (hand_ - p_).squaredNorm();
    const Vec2 off = rest.p + kOff * rest.n;
    if (probe(off).distance < 0.0) return false;  // no room there
    for (const double turn : {0.0, kAside, -kAside, 2.0 * kAside, -2.0 * kAside}) {
      const Vec2 way = Pose2::turned(rest.n, turn);
      const Vec2 hand = hand_;
      hand_ = rest.p + kHop * way;
      p_ = off;
      touching_ = false;
      clearance_ = 0.0;
      stride_ = kShortStride;
      travel();
      hand_ = hand;
      touching_ = false;
      clearance_ = 0.0;
      for (bool there = false; !there && work_ < kMaxWork;) there = touching_ ? slide() : travel();
      if ((hand_ - p_).squaredNorm() < nearest - kGain * std::sqrt(nearest)) return true;
    }
    p_ = rest.p;
    n_ = rest.n;
    bend_ = rest.bend;
    limit_ = rest.limit;
    touching_ = true;
    fine_ = true;
    stuck_ = hand_;
    return false;
  }

  // Puts the proxy at the free point nearest to `p`, or at the scene's start.
  void place(const Vec2& p) noexcept {
    touching_ = false;
    clearance_ = 0.0;
    stride_ = kShortStride;
    limit_ = kLongSlide;
    held_ = stuck_ = Vec2::Constant(-1e9);
    p_ = p;
    if (probe(p_).distance >= 0.0) return;
    const Vec2 middle(std::floor(p.x()) + 0.5, std::floor(p.y()) + 0.5);
    double best = 1e9;
    for (int ring = 0; ring <= kSearch && ring - 1.0 < best; ++ring) {
      for (int i = -ring; i <= ring; ++i) {
        for (const Vec2& d : {Vec2(i, ring), Vec2(i, -ring), Vec2(ring, i), Vec2(-ring, i)}) {
          const Vec2 q = middle + d;
          const double far = (q - p).norm();
          if (far >= best || probe(q).distance < 0.0) continue;
          best = far;
          p_ = q;
        }
      }
    }
    if (best < 1e9) {
      // From the nearest pixel to the surface before `p`, then along it.
      const Vec2 hand = hand_;
      hand_ = p;
      for (int i = 0; i < kMaxWork; ++i) {
        work_ = 0;
        if (touching_ ? slide() : travel()) break;
      }
      hand_ = hand;
    } else {
      p_ = to_pixels(walls_.start);
    }
  }

  std::size_t pixel_at(const Vec2& p) const noexcept {
    const int x = static_cast<int>(std::clamp(p.x(), 0.0, map_.width - 1.0));
    const int y = static_cast<int>(std::clamp(p.y(), 0.0, map_.height - 1.0));
    return static_cast<std::size_t>(map_.height - 1 - y) * static_cast<std::size_t>(map_.width) +
           static_cast<std::size_t>(x);
  }

  // On the surface the proxy's own pixel may be mostly wall: the free one is before it.
  std::uint8_t region_at_proxy() const noexcept {
    std::uint8_t region = 0;
    for (int half = 0; half < 4; ++half) {
      region = map_.region[pixel_at(p_ + 0.5 * half * n_)];
      if (!touching_ || walls_.regions[region].kind != RegionKind::kWall) break;
    }
    return region;
  }

  std::uint8_t wall_at_proxy() const noexcept {
    for (int half = 0; half < 4; ++half) {
      const std::uint8_t wall = map_.wall[pixel_at(p_ - 0.5 * half * n_)];
      const bool there = (fields_[field_].gone >> (wall & 63) & 1) == 0;
      if (there && walls_.regions[wall].kind == RegionKind::kWall) return wall;
    }
    return border_;
  }

  const Walls& walls_;
  const CoverageMap& map_;
  Vec2 half_;                  // of the map
  std::vector<Field> fields_;  // one per set of vanished walls
  std::size_t field_ = 0;      // the one in force
  std::uint8_t border_ = 0;    // the wall around the map

  Vec2 hand_ = Vec2::Zero();
  Vec2 held_ = Vec2::Constant(-1e9);   // the waiting hand whose proxy comes no nearer
  Vec2 stuck_ = Vec2::Constant(-1e9);  // the hand when the proxy was last found held by a corner
  Vec2 p_ = Vec2::Zero();              // the proxy
  bool touching_ = false;
  double clearance_ = 0.0;  // free: no wall is nearer
  double stride_ = kShortStride;
  Vec2 n_ = Vec2::UnitY();     // touching: out of the wall
  double bend_ = 0.0;          // touching: of the surface
  bool fine_ = true;           // touching: where walls may be one pixel thin
  double limit_ = kLongSlide;  // touching: of the next slide
  int work_ = 0;               // probes so far this tick
};

}  // namespace

std::unique_ptr<WallProxy> make_subpixel_proxy(const Walls& walls) {
  if (walls.map == nullptr) throw std::invalid_argument("a sub-pixel wall needs a painted map");
  return std::make_unique<SubpixelWall>(walls);
}

}  // namespace handrail
