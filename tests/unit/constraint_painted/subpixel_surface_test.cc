// The sub-pixel proxy against closed forms: lines, circles, corners and junctions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/constraint/painted/subpixel_wall.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

constexpr double kSurfacePixel = 1e-4;
constexpr double kSurfaceStiffness = 5000.0;

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

// Errors of proxies against where they should be.
struct Errors {
  double squares = 0.0, worst = 0.0, turn = 0.0, least_force = 1e9, greatest_force = 0.0;
  int count = 0;

  void add(const WallContact& contact, const Vec2& hand, const Vec2& right, const Vec2& normal) {
    ASSERT_TRUE(contact.touching);
    const double off = (contact.proxy - right).norm();
    squares += off * off;
    worst = std::max(worst, off);
    turn = std::max(turn, std::acos(std::min(contact.normal.dot(normal), 1.0)));
    const double force = kSurfaceStiffness * (contact.proxy - hand).norm();
    least_force = std::min(least_force, force);
    greatest_force = std::max(greatest_force, force);
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
  double ripple() const { return greatest_force - least_force; }
};

// Along both faces of a straight wall, `depth` inside it.
Errors along_line(double angle, double thickness, double depth) {
  const Vec2 n = unit(angle + 0.5 * std::numbers::pi), t = unit(angle);
  const double off = 0.37 * kSurfacePixel;
  Errors errors;
  for (const double side : {1.0, -1.0}) {
    const Walls walls = test::straight_wall(100, kSurfacePixel, thickness, angle, off);
    const auto proxy = make_subpixel_proxy(walls);
    const Vec2 face = (off + 0.5 * side * thickness) * n;
    proxy->start(face + side * 10.0 * kSurfacePixel * n);
    for (double s = -2.5e-3; s < 2.5e-3; s += 0.173e-4) {
      const Vec2 hand = face + s * t - side * depth * n;
      errors.add(proxy->advance(hand), hand, face + s * t, side * n);
    }
  }
  return errors;
}

// Around a disc of wall (`solid`), or inside a hole in it, `depth` inside the wall.
Errors around_circle(double r, bool solid, double depth, int levels = 0) {
  const int size = static_cast<int>(2.0 * r / kSurfacePixel) + 60;
  const Vec2 c(0.31 * kSurfacePixel, 0.17 * kSurfacePixel);
  test::WallPainter painter(size, size, kSurfacePixel, solid);
  if (solid) {
    painter.wall_disc(c, r);
  } else {
    painter.open_disc(c, r);
  }
  const Walls walls = painter.finish(Vec2::Zero(), levels);
  const auto proxy = make_subpixel_proxy(walls);
  const double out = solid ? 1.0 : -1.0;
  proxy->start(c + (r + out * 1e-3) * unit(0.0));
  Errors errors;
  for (double a = 0.0; a < 2.0 * std::numbers::pi; a += 0.05e-3 / r) {
    const Vec2 hand = c + (r - out * depth) * unit(a);
    errors.add(proxy->advance(hand), hand, c + r * unit(a), out * unit(a));
  }
  return errors;
}

TEST(SubpixelSurface, LinesAtAnyAngleAreWithinHalfAMicrometre) {
  for (int i = 0; i <= 90; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 181.0;
    const Errors errors = along_line(angle, 3.0 * kSurfacePixel, 1e-4);
    EXPECT_LT(errors.rms(), 0.5e-6) << angle;
    EXPECT_LT(errors.ripple(), 0.01) << angle;
    EXPECT_LT(errors.turn, 1.0 * std::numbers::pi / 180.0) << angle;
  }
}

TEST(SubpixelSurface, WallsOfTwoPixelsAreWithinHalfAMicrometreToo) {
  for (int i = 0; i <= 60; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 121.0;
    const Errors errors = along_line(angle, 2.0 * kSurfacePixel, 0.5e-4);
    EXPECT_LT(errors.rms(), 0.5e-6) << angle;
    EXPECT_LT(errors.ripple(), 0.01) << angle;
    EXPECT_LT(errors.turn, 1.0 * std::numbers::pi / 180.0) << angle;
  }
}

TEST(SubpixelSurface, LinesOfSlopeOneHalfThroughHalfPixelsAreExactToo) {
  const double angle = std::atan(0.5);
  EXPECT_LT(along_line(angle, 4.0 * kSurfacePixel, 1e-4).rms(), 0.1e-6);
}

TEST(SubpixelSurface, CirclesAreWithinAMicrometre) {
  for (const double r : {2e-3, 3e-3, 8e-3}) {
    for (const bool solid : {true, false}) {
      const Errors errors = around_circle(r, solid, r / 20.0);
      EXPECT_LT(errors.rms(), 1e-6) << r << solid;
      EXPECT_LT(errors.worst, 2e-6) << r << solid;
      EXPECT_LT(errors.ripple(), 0.01) << r << solid;
      EXPECT_LT(errors.turn, 1.0 * std::numbers::pi / 180.0) << r << solid;
    }
  }
}

TEST(SubpixelSurface, EightBitCoverageKeepsTheFigures) {
  const Errors errors = around_circle(3e-3, false, 2e-4, 256);
  EXPECT_LT(errors.rms(), 1e-6);
  EXPECT_LT(errors.worst, 2e-6);
}

TEST(SubpixelSurface, AHandDeepInsideAConvexWallIsStraightBehindItsProxy) {
  // A tenth of the radius from the centre, what the normal is off counts tenfold.
  EXPECT_LT(around_circle(3e-3, true, 2.7e-3).worst, 2.7e-3 * std::numbers::pi / 180.0);
}

TEST(SubpixelSurface, AHandFarBehindAConcaveWallIsStraightBehindItsProxy) {
  EXPECT_LT(around_circle(3e-3, false, 9e-3).worst, 2e-6);
}

TEST(SubpixelSurface, TheCornerOfAnAisleHoldsTheProxyWithinHalfAPixel) {
  // A hand pushed out past the corner of a turned rectangle is nearest to the corner itself.
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.13 * i;
    const Walls walls = test::WallPainter(160, 160, kSurfacePixel, false)
                            .open(test::rectangle(Vec2::Zero(), 8e-3, 6e-3, angle))
                            .finish();
    const auto proxy = make_subpixel_proxy(walls);
    proxy->start(Vec2::Zero());
    const Vec2 corner = Pose2::turned({4e-3, 3e-3}, angle);
    const WallContact contact = proxy->advance(1.5 * corner);
    EXPECT_TRUE(contact.touching);
    EXPECT_LT((contact.proxy - corner).norm(), 0.4 * kSurfacePixel) << angle;
  }
}

TEST(SubpixelSurface, AProxyGoesRoundTheTipOfAWallButNotThroughIt) {
  // A wall ends at the origin. The hand goes round its end, then deep into it.
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.29 * i;
    const Vec2 t = unit(angle), n = unit(angle + 0.5 * std::numbers::pi);
    const Walls walls = test::WallPainter(200, 200, kSurfacePixel)
                            .wall(test::rectangle(-5e-3 * t, 1e-2, 4e-4, angle))
                            .finish(2e-3 * t);
    const auto proxy = make_subpixel_proxy(walls);
    proxy->start(1e-3 * n - 2e-3 * t);
    WallContact contact = proxy->advance(-1e-3 * n - 2e-3 * t);  // straight through
    EXPECT_NEAR(contact.proxy.dot(n), 2e-4, 1e-6);
    for (double s = -2e-3; s < 1e-3; s += 5e-5) contact = proxy->advance(-1e-3 * n + s * t);
    EXPECT_FALSE(contact.touching);
    contact = proxy->advance(-2e-3 * t);
    EXPECT_NEAR(contact.proxy.dot(n), -2e-4, 1e-6) << angle;
  }
}

TEST(SubpixelSurface, AJunctionOfAislesIsFeltWallByWall) {
  // A cross of two aisles. The hand presses against the lower wall, enters the mouth of the side
  // aisle and is held there by that aisle's far wall.
  const double angle = 0.4;
  const Walls walls = test::WallPainter(300, 300, kSurfacePixel, false)
                          .open(test::rectangle(Vec2::Zero(), 2.4e-2, 4e-3, angle))
                          .open(test::rectangle(Vec2::Zero(), 4e-3, 2.4e-2, angle))
                          .finish();
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 t = unit(angle), n = unit(angle + 0.5 * std::numbers::pi);
  proxy->start(-9e-3 * t);
  for (double s = -9e-3; s < 9e-3; s += 1e-4) {
    const WallContact contact = proxy->advance(s * t - 2.5e-3 * n);
    ASSERT_FALSE(contact.unfinished);
    const Vec2 wanted = std::min(s, 2e-3) * t - (s > -2e-3 ? 2.5e-3 : 2e-3) * n;
    if (std::abs(std::abs(s) - 2e-3) < 6e-4) continue;  // around the corners
    EXPECT_LT((contact.proxy - wanted).norm(), 0.1 * kSurfacePixel) << s;
  }
}

}  // namespace
}  // namespace handrail
