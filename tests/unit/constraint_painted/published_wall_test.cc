// Algorithm 1 on painted walls: what it does, and each of its documented faults.
#include "server/constraint/painted/published_wall.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/support/no_allocation.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using namespace test;

constexpr double kPixel = 1e-4;      // [m]
constexpr double kStiffness = 5000;  // [N/m]

Walls with_radius(Walls walls, double pixels) {
  walls.method = WallMethod::kPublished;
  walls.search_radius = pixels;
  return walls;
}

// The upper half of the map is wall from `y` on, turned by `angle`.
Walls ceiling(double y, double angle, double radius) {
  const Vec2 n(std::sin(angle), -std::cos(angle));
  return with_radius(WallPainter(400, 400, kPixel).wall(half_plane(-y * n, n)).finish(), radius);
}

// A scan as printed, from the paper's lines alone and without a bound: row by row from the top.
Vec2 algorithm_1(const Walls& walls, Vec2 proxy, const Vec2& hand) {
  const CoverageMap& map = *walls.map;
  const double r = walls.search_radius * map.pixel;
  for (bool again = true; again;) {
    again = false;
    for (int row = 0; row < map.height && !again; ++row) {
      for (int column = 0; column < map.width && !again; ++column) {
        const Vec2 p((column + 0.5 - 0.5 * map.width) * map.pixel,
                     (0.5 * map.height - row - 0.5) * map.pixel);
        if ((p - proxy).norm() >= r - 1e-12) continue;
        if (map.open[static_cast<std::size_t>(row * map.width + column)] < 32768) continue;
        if ((p - hand).norm() >= (proxy - hand).norm() - 1e-12) continue;
        proxy = p;
        again = true;
      }
    }
  }
  return proxy;
}

TEST(PublishedWall, EndsOnThePixelThatThePrintedLinesEndOn) {
  std::mt19937_64 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const double radius : {1.2, 1.5, 2.5, 4.0}) {
    for (int scene = 0; scene < 5; ++scene) {
      WallPainter painter(40, 40, kPixel);
      for (int i = 0; i < 6; ++i) {
        painter.wall_disc({between(-2e-3, 2e-3), between(-2e-3, 2e-3)}, between(1e-4, 6e-4));
      }
      painter.open_disc({0, 0}, 3e-4);
      const Walls walls = with_radius(painter.finish(), radius);
      const auto proxy = make_published_proxy(walls);
      Vec2 printed = Vec2(0.5, 0.5) * kPixel;
      proxy->start(printed);
      for (int i = 0; i < 60; ++i) {
        const Vec2 hand(between(-2.5e-3, 2.5e-3), between(-2.5e-3, 2.5e-3));
        printed = algorithm_1(walls, printed, hand);
        WallContact contact = proxy->advance(hand);
        for (int k = 0; contact.unfinished && k < 10; ++k) contact = proxy->advance(hand);
        ASSERT_FALSE(contact.unfinished);
        if (contact.touching) {
          ASSERT_LT((contact.proxy - printed).norm(), 1e-12);
        } else {
          ASSERT_LE((hand - printed).cwiseAbs().maxCoeff(), 0.5 * kPixel + 1e-12);
        }
      }
    }
  }
}

TEST(PublishedWall, AFreeHandIsItsOwnProxy) {
  const Walls walls = ceiling(5e-3, 0.0, 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  const WallContact contact = proxy->advance({1.234e-3, 2.345e-3});
  EXPECT_EQ(contact.proxy, Vec2(1.234e-3, 2.345e-3));
  EXPECT_FALSE(contact.touching);
  EXPECT_EQ(contact.region, 0);
}

TEST(PublishedWall, BehindAWallAlongTheRowsTheProxyIsItsLastFreePixel) {
  const Walls walls = ceiling(5e-3, 0.0, 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  const WallContact contact = proxy->advance({1.05e-3, 6e-3});
  EXPECT_TRUE(contact.touching);
  EXPECT_NEAR(contact.proxy.x(), 1.05e-3, 1e-12);
  EXPECT_NEAR(contact.proxy.y(), 4.95e-3, 1e-12);
  EXPECT_NEAR(contact.normal.y(), -1.0, 1e-9);
  EXPECT_EQ(contact.wall, 1);
}

// Fault 1: the loop is unbounded. A hand that would need ten thousand tests gets a tick's worth and
// the rest later, and the place is the same.
TEST(PublishedWall, ALongWayIsCutIntoTicksOfBoundedWork) {
  const Walls walls = with_radius(WallPainter(2000, 100, kPixel).finish({-0.099, 0}), 4.0);
  const auto proxy = make_published_proxy(walls);
  proxy->start({-0.099, 0});
  const Vec2 hand(0.09, 0.001);
  int ticks = 0;
  Vec2 last(-0.099, 0);
  for (WallContact contact; ticks == 0 || contact.unfinished; ++ticks) {
    contact = proxy->advance(hand);
    ASSERT_LE(contact.work, kMaxPixelTests);
    ASSERT_LT((contact.proxy - hand).norm(), (last - hand).norm());
    last = contact.proxy;
    ASSERT_LT(ticks, 100);
  }
  EXPECT_GT(ticks, 2);
  EXPECT_EQ(last, hand);
}

TEST(PublishedWall, ARadiusWhoseScanExceedsTheBoundStillGetsOneScan) {
  const Walls walls = with_radius(WallPainter(300, 300, kPixel).finish(), 60.0);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  WallContact contact = proxy->advance({0.01, 0.01});
  for (int i = 0; i < 1000 && contact.unfinished; ++i) contact = proxy->advance({0.01, 0.01});
  EXPECT_EQ(contact.proxy, Vec2(0.01, 0.01));
}

// Fault 2: greedy descent sticks. A pocket one pixel deep holds the proxy while the hand goes on.
TEST(PublishedWall, SticksInAPocketThatAWiderSearchLeaves) {
  WallPainter painter(400, 400, kPixel);
  painter.wall(half_plane({0, 5e-3}, {0, -1})).open(rectangle({5e-5, 5.15e-3}, kPixel, 3e-4, 0.0));
  for (const double radius : {1.5, 5.0}) {
    const Walls walls = with_radius(painter.finish(), radius);
    const auto proxy = make_published_proxy(walls);
    proxy->start({5e-5, 5.25e-3});
    proxy->advance({5e-5, 6e-3});
    const WallContact contact = proxy->advance({1.05e-3, 5.5e-3});
    EXPECT_EQ(contact.proxy.x() < 2e-4, radius == 1.5) << radius;
  }
}

// Fault 2 again: at a radius of 1.5 pixels it stays far behind on a slanting wall, because every
// next pixel of the stairs is a little farther from the hand; a radius of 4 stays behind by less.
TEST(PublishedWall, StaysBehindOnASlantingWallAtASmallRadius) {
  const auto worst_behind = [](double radius) {
    double worst = 0.0;
    for (int degrees = 1; degrees < 45; degrees += 2) {
      const double angle = degrees * std::numbers::pi / 180.0;
      const Walls walls = ceiling(2e-3, angle, radius);
      const auto proxy = make_published_proxy(walls);
      const Vec2 along(std::cos(angle), std::sin(angle)), up(-std::sin(angle), std::cos(angle));
      proxy->start(-0.01 * along);
      for (int i = -100; i <= 100; ++i) {
        const Vec2 hand = 1e-4 * i * along + 3e-3 * up;
        const Vec2 p = proxy->advance(hand).proxy;
        worst = std::max(worst, (hand - p).dot(along));
      }
    }
    return worst;
  };
  EXPECT_GT(worst_behind(1.5), 9e-4);
  EXPECT_LT(worst_behind(4.0), 4e-4);
}

// Fault 3: the surface has steps of a pixel. Along a slanting wall at constant depth force should
// be constant; it varies by up to K times a pixel and more.
TEST(PublishedWall, ForceHasARippleOfPixels) {
  for (const double radius : {1.5, 2.5, 4.0}) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    const double angle = 0.3;
    const Walls walls = ceiling(2e-3, angle, radius);
    const auto proxy = make_published_proxy(walls);
    const Vec2 along(std::cos(angle), std::sin(angle)), up(-std::sin(angle), std::cos(angle));
    proxy->start(-0.005 * along);
    for (int i = -5000; i <= 5000; ++i) {
      const Vec2 hand = 1e-6 * i * along + 3e-3 * up;
      const double force = kStiffness * (proxy->advance(hand).proxy - hand).norm();
      if (i < -3000) continue;
      least = std::min(least, force);
      most = std::max(most, force);
    }
    EXPECT_GT(most - least, 0.2) << radius;
    EXPECT_LT(most - least, 3.0) << radius;
  }
}

// Fault 4: a hand that jumps. The proxy goes from pixel to pixel, so speed alone never takes it
// through; but nothing checks the way between two pixels.
bool crosses(const Walls& walls, const Vec2& from, const Vec2& to) {
  const auto proxy = make_published_proxy(walls);
  proxy->start(from);
  Vec2 p = from;
  for (int i = 0; i < 20; ++i) p = proxy->advance(to).proxy;
  return p == to;
}

TEST(PublishedWall, AJumpOfAnyLengthStaysBeforeAWallAsWideAsTheSearchLessOnePixel) {
  for (const double radius : {1.5, 2.0, 2.5, 4.0}) {
    for (int width = 1; width <= 4; ++width) {
      const Walls walls =
          with_radius(WallPainter(200, 200, kPixel)
                          .wall(rectangle({0, 5e-5 * width}, 1.0, kPixel * width, 0))
                          .finish({0, -5e-3}),
                      radius);
      const bool through = crosses(walls, {5e-5, -5e-3}, {5e-5, 8e-3});
      EXPECT_EQ(through, width + 1 < radius) << radius << " pixels, wall of " << width;
    }
  }
}

TEST(PublishedWall, ADiagonalOfSinglePixelsHoldsOnlyUpToARadiusOfSqrt2) {
  Walls walls = WallPainter(100, 100, kPixel).finish({-2e-3, 2e-3});
  CoverageMap map = *walls.map;
  for (int i = 0; i < 100; ++i) {
    const auto at = static_cast<std::size_t>(i * 100 + i);
    map.open[at] = 0;
    map.region[at] = 1;
  }
  walls.map = std::make_shared<const CoverageMap>(map);
  const Vec2 from(-2.05e-3, -2.05e-3), to(2.05e-3, 2.05e-3);
  EXPECT_FALSE(crosses(with_radius(walls, 1.4), from, to));
  EXPECT_TRUE(crosses(with_radius(walls, 1.5), from, to));
}

// Fault 5: border, islands, and a hand that starts inside a wall.
TEST(PublishedWall, NeverLeavesTheMap) {
  const Walls walls = with_radius(WallPainter(100, 60, kPixel).finish(), 2.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  for (const double far : {0.01, 1.0, 1e30}) {
    for (const Vec2& u : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1), Vec2(1, 1)}) {
      for (int i = 0; i < 5; ++i) {
        const WallContact contact = proxy->advance(far * u);
        EXPECT_LE(std::abs(contact.proxy.x()), 50 * kPixel);
        EXPECT_LE(std::abs(contact.proxy.y()), 30 * kPixel);
        EXPECT_TRUE(contact.touching);
      }
    }
  }
}

TEST(PublishedWall, AHandThatPassesThroughAnIslandLeavesItsProxyOnTheNearSide) {
  const Walls walls =
      with_radius(WallPainter(200, 200, kPixel).wall_disc({0, 0}, 2e-3).finish({-5e-3, 0}), 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({-5e-3, 0});
  for (double x = -5e-3; x <= -1e-4; x += 1e-4) {
    EXPECT_LE(proxy->advance({x, 5e-5}).proxy.x(), -1.5e-3);
  }
}

TEST(PublishedWall, AHandInsideAWallStartsAtTheNearestFreePixelOrAtTheScenesStart) {
  Walls walls = ceiling(5e-3, 0.0, 1.5);
  const auto proxy = make_published_proxy(walls);
  EXPECT_LT((proxy->start({1.05e-3, 9.5e-3}) - Vec2(1.05e-3, 4.95e-3)).norm(), 1e-9);
  walls.start = {2.05e-3, 1.05e-3};
  EXPECT_LT((proxy->start({1.05e-3, 1.5e-2}) - walls.start).norm(), 1e-9);
  EXPECT_EQ(proxy->start({NAN, 0.0}), walls.start);
}

TEST(PublishedWall, AWallThatIsGoneIsFreeAndPushesTheProxyOutWhenItReturns) {
  const Walls walls = ceiling(5e-3, 0.0, 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 4e-3});
  proxy->set_gone(1u << 1);
  EXPECT_EQ(proxy->advance({5e-5, 7e-3}).proxy, Vec2(5e-5, 7e-3));
  proxy->set_gone(0);
  const WallContact contact = proxy->advance({5e-5, 7e-3});
  EXPECT_TRUE(contact.touching);
  EXPECT_NEAR(contact.proxy.y(), 4.95e-3, 1e-12);
}

TEST(PublishedWall, AMapThatIsAllWallIsHarmless) {
  const Walls walls = with_radius(WallPainter(100, 100, kPixel, false).finish({1.0, 1.0}), 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  EXPECT_TRUE(proxy->advance({1e-3, 1e-3}).proxy.allFinite());
}

TEST(PublishedWall, AHandThatIsNotFiniteCountsAsOneThatHasNotMoved) {
  const Walls walls = ceiling(5e-3, 0.0, 1.5);
  const auto proxy = make_published_proxy(walls);
  proxy->start({0, 0});
  proxy->advance({1e-3, 2e-3});
  EXPECT_EQ(proxy->advance({NAN, 0.0}).proxy, Vec2(1e-3, 2e-3));
  EXPECT_EQ(proxy->advance({0.0, -INFINITY}).proxy, Vec2(1e-3, 2e-3));
}

TEST(PublishedWall, StepsDoNotTouchTheHeap) {
  const Walls walls = ceiling(5e-3, 0.2, 2.5);
  const auto proxy = make_published_proxy(walls);
  NoAllocation guard("a step of the published proxy");
  proxy->start({0, 0});
  for (int i = 0; i < 3000; ++i) {
    proxy->advance(Vec2(0.015 * std::sin(0.37 * i), 0.015 * std::cos(0.23 * i)));
    if (i % 500 == 0) proxy->set_gone(i % 1000 == 0 ? 2u : 0u);
  }
}

TEST(PublishedWall, NeedsAMap) {
  EXPECT_THROW(make_published_proxy(Walls()), std::invalid_argument);
}

}  // namespace
}  // namespace handrail
