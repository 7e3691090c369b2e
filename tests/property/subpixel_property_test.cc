// The sub-pixel proxy under generated walls, hands and motions.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/constraint/painted/subpixel_wall.h"
#include "tests/property/draws.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within_square;

constexpr double kPixel = 1e-4;

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

// A convex polygon with corners on a circle of radius `r` [m], none sharper than 30 deg.
test::Polygon room_of(int corners, const Vec2& centre, double r) {
  const double first = between(0.0, 2.0 * std::numbers::pi);
  test::Polygon out;
  for (int i = 0; i < corners; ++i) {
    const double turn = (i + between(-0.25, 0.25)) / corners;
    out.push_back(centre + r * unit(first + 2.0 * std::numbers::pi * turn));
  }
  return out;
}

// A hand that keeps a velocity for some ticks and stays near the map.
struct Hand {
  Vec2 p, v = Vec2::Zero();
  double speed, room;

  const Vec2& next() {
    if (below(10) == 0) v = within_square(speed);
    p = (p + v).cwiseMax(Vec2(-room, -room)).cwiseMin(Vec2(room, room));
    return p;
  }
};

RC_GTEST_PROP(SubpixelProperty, NoMotionTakesTheProxyThroughAWallOfOnePixel, ()) {
  const double thickness = between(1.0, 4.0) * kPixel;
  const double speed = std::pow(10.0, between(-4.5, std::log10(5e-3)));  // [m a tick]
  const int kind = below(3);  // a straight wall from border to border, a ring, a fence with corners
  const double angle = between(0.0, 2.0 * std::numbers::pi), r = between(2e-3, 8e-3);
  const Vec2 off = within_square(1e-3), n = unit(angle + 0.5 * std::numbers::pi);
  const int corners = 3 + below(3);
  test::WallPainter painter(240, 240, kPixel);
  const auto fence = [&](double reach) {
    test::Polygon out;
    for (int i = 0; i < corners; ++i) {
      out.push_back(off + reach * unit(angle + 2.0 * std::numbers::pi * i / corners));
    }
    return out;
  };
  // Of the fence, from the middle to a side.
  const double inner = r * std::cos(std::numbers::pi / corners);
  if (kind == 0) {
    painter.wall(test::rectangle(off, 1.0, thickness, angle));
  } else if (kind == 1) {
    painter.wall_disc(off, r + 0.5 * thickness).open_disc(off, r - 0.5 * thickness);
  } else {
    painter.wall(fence(r + thickness / std::cos(std::numbers::pi / corners))).open(fence(r));
  }
  const Vec2 start = kind == 0 ? Vec2(off + 2e-3 * n) : off;
  const Walls walls = painter.finish(start);
  // How far the proxy is inside the wall's far face.
  const auto side = [&](const Vec2& p) {
    if (kind == 0) return (p - off).dot(n) + 0.5 * thickness;
    if (kind == 1) return r + 0.5 * thickness - (p - off).norm();
    double nearest = 1e9;
    for (int i = 0; i < corners; ++i) {
      const Vec2 out = unit(angle + 2.0 * std::numbers::pi * (i + 0.5) / corners);
      nearest = std::min(nearest, inner + thickness - (p - off).dot(out));
    }
    return nearest;
  };
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(start);
  Hand hand{start, Vec2::Zero(), speed, 0.014};
  int unfinished = 0;
  for (int i = 0; i < 400; ++i) {
    const WallContact contact = proxy->advance(hand.next());
    RC_ASSERT(side(contact.proxy) > 0.25 * kPixel);
    RC_ASSERT(std::abs(contact.proxy.x()) < 0.01205 && std::abs(contact.proxy.y()) < 0.01205);
    unfinished = contact.unfinished ? unfinished + 1 : 0;
    RC_ASSERT(unfinished < 20);
  }
}

// The nearest point of a convex polygon.
Vec2 nearest_in(const test::Polygon& room, const Vec2& p) {
  Vec2 nearest = p;
  double least = 1e9;
  bool inside = true;
  for (std::size_t i = 0; i < room.size(); ++i) {
    const Vec2 &a = room[i], d = room[(i + 1) % room.size()] - a;
    inside = inside && d.x() * (p - a).y() - d.y() * (p - a).x() >= 0.0;
    const Vec2 foot = a + std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d;
    if ((foot - p).norm() < least) least = (foot - p).norm(), nearest = foot;
  }
  return inside ? p : nearest;
}

RC_GTEST_PROP(SubpixelProperty, InAConvexRoomTheProxyIsWhereTheNearestFreePointIs, ()) {
  // There that is the only local minimum, whatever the path: no other is made by pixels. Corners of
  // down to 30 deg are round by half a pixel.
  const test::Polygon room = room_of(3 + below(4), within_square(3e-4), between(4e-3, 1e-2));
  const double depth = below(2) == 0 ? 1e-4 : 1e-3;
  const Walls walls = test::WallPainter(240, 240, kPixel, false).open(room).finish();
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(Vec2::Zero());
  Hand hand{Vec2::Zero(), Vec2::Zero(), std::pow(10.0, between(-5.0, -2.3)), 0.0115};
  for (int i = 0; i < 300; ++i) {
    Vec2 p = hand.next();
    const Vec2 nearest = nearest_in(room, p);
    const double far = (p - nearest).norm();
    if (far > depth) hand.p = p = nearest + depth / far * (p - nearest);
    const WallContact contact = proxy->advance(p);
    if (contact.unfinished) continue;
    RC_ASSERT((contact.proxy - nearest).norm() < (depth < 2e-4 ? 0.8 : 1.2) * kPixel);
  }
}

RC_GTEST_PROP(SubpixelProperty, AHandPassingAWallsTipTakesTheProxyRoundIt, ()) {
  const double thickness = between(1.0, 6.0) * kPixel, angle = between(0.0, 2.0 * std::numbers::pi);
  const double depth = between(0.5, 3.0) * thickness;
  const Vec2 t = unit(angle), n = unit(angle + 0.5 * std::numbers::pi), off = within_square(kPixel);
  const Walls walls = test::WallPainter(240, 240, kPixel)
                          .wall(test::rectangle(off - 4e-3 * t, 8e-3, thickness, angle))
                          .finish(off + 2e-3 * n);
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 face = off + 0.5 * thickness * n;
  proxy->start(face + 1e-3 * n - 4e-4 * t);
  WallContact contact = proxy->advance(face - depth * n - 4e-4 * t);
  RC_ASSERT(contact.touching);
  Vec2 hand;
  for (double s = -4e-4; s < 1e-3; s += 2e-5) {
    hand = face - depth * n + s * t;
    do contact = proxy->advance(hand);
    while (contact.unfinished);
  }
  RC_ASSERT((contact.proxy - hand).norm() < 1e-9);
}

// Rooms, an island and a gap: a bit of everything.
Walls busy_map() {
  return test::WallPainter(240, 240, kPixel, false)
      .open(test::rectangle({-4e-3, 0.0}, 8e-3, 1.6e-2, 0.2))
      .open_disc({6.5e-3, 5e-3}, 3e-3)
      .wall_disc({-4e-3, 1e-3}, 2e-3)
      .wall(test::rectangle({-4e-3, -5e-3}, 5e-3, 2e-4, 0.9))
      .finish({-4e-3, 5e-3});
}

RC_GTEST_PROP(SubpixelProperty, AWaitingHandsProxyComesToRestAndNeverGoesAway, ()) {
  static const Walls walls = busy_map();
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(walls.start);
  for (int jump = 0; jump < 10; ++jump) {
    const Vec2 hand = within_square(0.013);
    WallContact contact = proxy->advance(hand);
    double distance = (contact.proxy - hand).norm();
    for (int i = 0; i < 60; ++i) {
      const Vec2 before = contact.proxy;
      const bool rests = !contact.unfinished;
      contact = proxy->advance(hand);
      const double now = (contact.proxy - hand).norm();
      RC_ASSERT(now <= distance + 0.7 * kPixel * !rests);  // a landing may step back onto the wall
      if (rests) RC_ASSERT((contact.proxy - before).norm() < 1e-8);
      distance = now;
    }
    RC_ASSERT(!contact.unfinished);
  }
}

RC_GTEST_PROP(SubpixelProperty, AwayFromCornersASmallStepOfTheHandIsASmallStepOfTheProxy, ()) {
  // Behind a wall that is convex with radius r, at depth r/2, the proxy goes twice as far.
  const double r = between(2e-3, 8e-3);
  const Vec2 c = within_square(1e-4);
  const Walls walls = test::WallPainter(240, 240, kPixel).wall_disc(c, r).finish({0.0, 0.011});
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({0.0, 0.011});
  const double a = between(0.0, 2.0 * std::numbers::pi);
  Vec2 hand = c + 0.5 * r * unit(a);
  proxy->start(c + (r + 2e-4) * unit(a));
  WallContact contact = proxy->advance(hand);
  for (int i = 0; i < 50; ++i) {
    const Vec2 before = contact.proxy, step = within_square(2e-5);
    if ((hand + step - c).norm() < 0.5 * r) continue;
    hand += step;
    contact = proxy->advance(hand);
    RC_ASSERT((contact.proxy - before).norm() <= 2.1 * step.norm() + 0.05 * kPixel);
  }
}

RC_GTEST_PROP(SubpixelProperty, MapAndHandTurnedTogetherGiveTheSameProxyTurned, ()) {
  // The same room, its walls at another angle to the pixels.
  const double angle = between(0.0, 2.0 * std::numbers::pi);
  const Vec2 shift = within_square(3e-4);
  const auto room = [](double by, const Vec2& at) {
    return test::WallPainter(260, 260, kPixel, false)
        .open(test::rectangle(at, 1.2e-2, 8e-3, by))
        .wall_disc(at + Pose2::turned({1e-3, 5e-4}, by), 2e-3)
        .finish(at + Pose2::turned({-4e-3, 0.0}, by));
  };
  static const Walls straight = room(0.0, Vec2::Zero());
  const Walls turned = room(angle, shift);
  const auto a = make_subpixel_proxy(straight), b = make_subpixel_proxy(turned);
  const Pose2 pose{shift, angle};
  a->start(straight.start);
  b->start(turned.start);
  Hand hand{straight.start, Vec2::Zero(), 2e-4, 0.0063};
  for (int i = 0; i < 300; ++i) {
    const Vec2& p = hand.next();
    const WallContact in_a = a->advance(p), in_b = b->advance(pose.to_world(p));
    // Behind the disc's centre the way round it is either; such a run ends.
    if ((p - Vec2(1e-3, 5e-4)).norm() < 5e-4) return;
    const bool corner = (Vec2(6e-3, 4e-3) - in_a.proxy.cwiseAbs()).maxCoeff() < 12.0 * kPixel;
    const double off = (pose.to_world(in_a.proxy) - in_b.proxy).norm();
    RC_ASSERT(off < (corner ? 0.8 : 0.3) * kPixel);
  }
}

}  // namespace
}  // namespace handrail
