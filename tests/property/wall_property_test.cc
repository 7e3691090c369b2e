// The exact proxy under generated walls and hands. tests/run --full raises the number of cases from
// 100 to 2000: then AJumpingHand... plays 10^6 motions.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <iomanip>
#include <random>
#include <sstream>

#include "devices/hand/recorded_hand_io.h"
#include "server/haptic/wall_proxies.h"
#include "tests/property/draws.h"
#include "tests/unit/constraint_drawn/shape_samples.h"

namespace handrail {
namespace {

using test::between;
using test::within_square;

using namespace test;

constexpr double kRounding = 1e-9;  // [m]

// Of a seed, so that long motions cost rapidcheck one number.
class Motion {
 public:
  Motion() : random_(*rc::gen::arbitrary<std::uint64_t>()) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec2 within_square(double size) { return {between(-size, size), between(-size, size)}; }

 private:
  std::mt19937_64 random_;
};

std::vector<WallShape> any_shapes() {
  std::vector<WallShape> shapes;
  const int count = static_cast<int>(between(1.0, 7.0));
  for (int i = 0; i < count; ++i) {
    const Vec2 c = within_square(0.04);
    const double kind = between(0.0, 3.0), from = between(-7.0, 7.0);
    if (kind < 1.0) {
      shapes.push_back(box(c, {between(1e-3, 0.04), between(1e-3, 0.02)}, from));
    } else if (kind < 2.0) {
      shapes.push_back(disc(c, between(1e-3, 0.03)));
    } else {
      shapes.push_back(
          arc_aisle(c, between(4e-3, 0.03), between(1e-3, 0.015), from, from + between(0.1, 7.0)));
    }
  }
  return shapes;
}

WallContact settle(WallProxy& proxy, const Vec2& hand) {
  WallContact contact = proxy.advance(hand);
  for (int i = 0; contact.unfinished && i < 100; ++i) contact = proxy.advance(hand);
  RC_ASSERT(!contact.unfinished);
  return contact;
}

RC_GTEST_PROP(WallProperty, TheProxyIsAlwaysInTheSetAndAtALocalMinimum, ()) {
  const Walls walls = drawn(any_shapes());
  const auto proxy = make_wall_proxy(walls);
  proxy->start(walls.start);
  Motion motion;
  Vec2 hand = walls.start;
  for (int i = 0; i < 30; ++i) {
    hand = i % 5 == 0 ? motion.within_square(0.08) : Vec2(hand + motion.within_square(2e-3));
    const WallContact contact = settle(*proxy, hand);
    RC_ASSERT(holds(walls, contact.proxy, kRounding));
    if (contact.touching) {
      RC_ASSERT(gain_nearby(walls, contact.proxy, hand) < 1e-9);
      RC_ASSERT(std::abs(contact.normal.norm() - 1.0) < 1e-9);
    } else {
      RC_ASSERT(contact.proxy == hand);
    }
  }
}

RC_GTEST_PROP(WallProperty, AWaitingHandNeverGetsAFartherProxy, ()) {
  // On stairs many ticks pass until it is there.
  const Walls walls = *rc::gen::arbitrary<bool>() ? stairs(100) : drawn(any_shapes());
  const auto proxy = make_wall_proxy(walls);
  proxy->start(walls.start);
  const Vec2 hand = Vec2(0.1, 0.0) + within_square(0.3);
  double distance = (proxy->advance(hand).proxy - hand).norm();
  for (int i = 0; i < 20; ++i) {
    const double now = (proxy->advance(hand).proxy - hand).norm();
    RC_ASSERT(now <= distance + 1e-15);
    distance = now;
  }
}

// The nearest free point of the rounded crossing, worked out by its symmetry.
Vec2 nearest_in_crossing(const Vec2& hand, double r) {
  Vec2 v = hand.cwiseAbs();
  const bool swapped = v.y() > v.x();
  if (swapped) std::swap(v.x(), v.y());
  const double c = 0.005 + r;
  Vec2 p(std::min(v.x(), 0.05), std::min(v.y(), 0.005));
  if (v.x() < c && v.y() > 0.005) {
    const Vec2 from_centre = v - Vec2(c, c);
    p = from_centre.norm() < r ? Vec2(Vec2(c, c) + r * from_centre.normalized()) : v;
  }
  if (swapped) std::swap(p.x(), p.y());
  return {std::copysign(p.x(), hand.x()), std::copysign(p.y(), hand.y())};
}

RC_GTEST_PROP(WallProperty, AwayFromMedialAxesTheProxyIsTheNearestPointAndMovesAtMostTwiceTheHand,
              ()) {
  // To a depth of half the fillet's radius its wall magnifies steps by at most 2; elsewhere 1.
  const double r = between(1e-3, 8e-3);
  const Walls walls = crossing(r);
  const auto proxy = make_wall_proxy(walls);
  Motion motion;
  Vec2 hand(0, 0), last = proxy->start(hand);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 next = hand + motion.within_square(1e-3) + Vec2(1e-4 * std::sin(1e-2 * i), 0);
    if ((nearest_in_crossing(next, r) - next).norm() > 0.5 * r) continue;
    const Vec2 p = proxy->advance(next).proxy;
    RC_ASSERT((p - nearest_in_crossing(next, r)).norm() < kRounding);
    RC_ASSERT((p - last).norm() <= 2.0 * (next - hand).norm() + kRounding);
    hand = next;
    last = p;
  }
}

RC_GTEST_PROP(WallProperty, TurningMapAndHandTogetherChangesNothing, ()) {
  const std::vector<WallShape> shapes = any_shapes();
  const Pose2 turn{within_square(0.1), between(-3.2, 3.2)};
  std::vector<WallShape> turned = shapes;
  for (WallShape& shape : turned) {
    shape.centre = turn.to_world(shape.centre);
    shape.angle += turn.angle;
    shape.from += turn.angle;
    shape.to += turn.angle;
  }
  const double fillet = *rc::gen::arbitrary<bool>() ? 0.0 : between(1e-4, 5e-3);
  const Walls a = drawn(shapes, fillet), b = drawn(turned, fillet);
  const auto one = make_wall_proxy(a), other = make_wall_proxy(b);
  one->start(a.start);
  other->start(turn.to_world(a.start));
  Motion motion;
  Vec2 hand = a.start;
  for (int i = 0; i < 100; ++i) {
    hand = i % 10 == 0 ? motion.within_square(0.08) : Vec2(hand + motion.within_square(2e-3));
    const WallContact u = settle(*one, hand), v = settle(*other, turn.to_world(hand));
    // A fillet between borders that nearly touch already has a place of its own only to 1e-8 m.
    RC_ASSERT((turn.to_world(u.proxy) - v.proxy).norm() < (fillet > 0.0 ? 1e-8 : kRounding));
  }
}

// Lanes beside lanes and rings around rings, 0.1 mm of wall between them; which one a point is in
// is plain from its coordinates.
struct ThinWalls {
  static constexpr int kCount = 9, kMiddle = kCount / 2;
  static constexpr double kPitch = 0.0051, kWidth = 0.005;
  double angle = 0.0;
  bool rings = false;

  Walls walls(int first) const {
    std::vector<WallShape> shapes;
    for (int i = 0; i < kCount; ++i) {
      const int k = (first + i) % kCount;
      const Vec2 c = Pose2::turned({0, (k - kMiddle) * kPitch}, angle);
      shapes.push_back(rings ? ring({0, 0}, (k + 2) * kPitch, kWidth)
                             : box(c, {0.06, 0.5 * kWidth}, angle));
    }
    return drawn(shapes);
  }
  bool contains(int k, const Vec2& p) const {
    const double across =
        rings ? p.norm() - (k + 2) * kPitch : Pose2::turned(p, -angle).y() - (k - kMiddle) * kPitch;
    return std::abs(across) <= 0.5 * kWidth + kRounding;
  }
};

ThinWalls any_thin_walls() { return {between(-3.2, 3.2), *rc::gen::arbitrary<bool>()}; }

RC_GTEST_PROP(WallProperty, AJumpingHandNeverTakesTheProxyOutOfTheFarFace, ()) {
  const ThinWalls thin = any_thin_walls();
  const int lane = static_cast<int>(between(0.0, ThinWalls::kCount - 1e-3));
  const Walls walls = thin.walls(lane);
  const auto proxy = make_wall_proxy(walls);
  proxy->start(walls.start);
  Motion motion;
  Vec2 hand = walls.start;
  for (int i = 0; i < 500; ++i) {
    // 5 m/s at 1 kHz are 5 mm a tick, any way; at times slower.
    hand += motion.within_square(i % 3 == 0 ? 5e-4 : 5e-3);
    if (hand.norm() > 0.08) hand = walls.start;
    const Vec2 p = proxy->advance(hand).proxy;
    RC_ASSERT(thin.contains(lane, p));
    RC_ASSERT(holds(walls, p, kRounding));
  }
}

RC_GTEST_PROP(WallProperty, ARecordedHandNeverTakesTheProxyOutOfTheFarFace, ()) {
  // As a pointer records: about nine samples a second, moves and rests.
  Motion motion;
  std::ostringstream csv;
  csv << "t_s,x_mm,y_mm\n" << std::fixed << std::setprecision(3);
  Vec2 at = Vec2::Zero();
  double t = 0.0;
  for (int i = 0; i < 12; ++i) {
    csv << t << ',' << at.x() << ',' << at.y() << '\n';
    t += motion.between(0.1, 0.13);
    if (motion.between(0, 1) < 0.8) at = motion.within_square(60.0);
  }
  std::istringstream in(csv.str());
  const auto recorded = read_recorded_motion(in, "generated.csv");
  RC_ASSERT(recorded.is_ok());
  const ThinWalls thin = any_thin_walls();
  const int lane = static_cast<int>(between(0.0, ThinWalls::kCount - 1e-3));
  const Walls walls = thin.walls(lane);
  const auto proxy = make_wall_proxy(walls);
  proxy->start(walls.start);
  for (int ms = 0; ms * 1e-3 < recorded->duration(); ++ms) {
    const Vec2 p = proxy->advance(recorded->at(ms * 1e-3).head<2>()).proxy;
    RC_ASSERT(thin.contains(lane, p));
    RC_ASSERT(holds(walls, p, kRounding));
  }
}

RC_GTEST_PROP(WallProperty, AtGrazingContactTheProxyIsNeverLeftBehind, ()) {
  // Along the wall, a few micrometres in or out of it, at up to 5 m/s around rounded corners.
  const double r = between(1e-3, 8e-3);
  const Walls walls = crossing(r);
  const auto proxy = make_wall_proxy(walls);
  proxy->start({0.04, 0.0});
  Motion motion;
  const double speed = between(1e-5, 5e-3), quarter = kQuarter * r, leg = 0.035 - r;
  for (double s = 0.0; s < 2.0 * leg + quarter; s += speed) {
    Vec2 p(0.04 - s, 0.005), n(0, -1);
    if (s > leg + quarter) {
      p = {0.005, 0.005 + r + (s - leg - quarter)};
      n = {-1, 0};
    } else if (s > leg) {
      n = Pose2::turned({0, -1}, -(s - leg) / r);
      p = Vec2(0.005 + r, 0.005 + r) + r * n;
    }
    const double out = motion.between(-2e-6, 2e-6);
    const Vec2 hand = p + out * n;
    RC_ASSERT((proxy->advance(hand).proxy - hand).norm() <= std::max(0.0, -out) + kRounding);
  }
}

}  // namespace
}  // namespace handrail
