// The sub-pixel proxy in the hard cases: jumps, pockets, islands, borders, starts inside walls.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "server/constraint/painted/subpixel_wall.h"
#include "tests/support/no_allocation.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

constexpr double kWallPixel = 1e-4;
constexpr int kMostWork = 220;  // probes a tick: the bound, and one landing or settling more

// Ticks until the proxy rests for a hand that waits.
WallContact settle(WallProxy& proxy, const Vec2& hand, int ticks = 50) {
  WallContact contact = proxy.advance(hand);
  for (int i = 0; i < ticks && contact.unfinished; ++i) contact = proxy.advance(hand);
  return contact;
}

TEST(SubpixelWall, InFreeSpaceTheProxyIsTheHand) {
  const Walls walls = test::straight_wall(100, kWallPixel, 4e-4, 0.3, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 hand(-1.23e-3, 3.1e-3);
  EXPECT_EQ(proxy->start({0.0, 2e-3}), Vec2(0.0, 2e-3));
  const WallContact contact = proxy->advance(hand);
  EXPECT_FALSE(contact.touching);
  EXPECT_EQ(contact.normal, Vec2::Zero());
  EXPECT_LT((contact.proxy - hand).norm(), 1e-15);
}

TEST(SubpixelWall, AHandThatJumpsThroughAWallLeavesTheProxyOnTheNearFace) {
  for (const double thickness : {1e-4, 2e-4, 1e-3}) {
    for (int i = 0; i < 24; ++i) {
      const double angle = 0.27 * i;
      const Walls walls = test::straight_wall(400, kWallPixel, thickness, angle, 0.0);
      const auto proxy = make_subpixel_proxy(walls);
      const Vec2 n(-std::sin(angle), std::cos(angle));
      proxy->start(1e-2 * n);
      const WallContact contact = settle(*proxy, -1e-2 * n);
      EXPECT_TRUE(contact.touching);
      EXPECT_NEAR(contact.proxy.dot(n), 0.5 * thickness, 0.2 * kWallPixel);
      EXPECT_EQ(contact.wall, 1);
    }
  }
}

TEST(SubpixelWall, TheMapsBorderIsWall) {
  const Walls walls = test::WallPainter(120, 80, kWallPixel).finish();
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(Vec2::Zero());
  EXPECT_LT((settle(*proxy, {0.03, 1e-3}).proxy - Vec2(6e-3, 1e-3)).norm(), 1e-7);
  EXPECT_LT((settle(*proxy, {-0.03, 1e-3}).proxy - Vec2(-6e-3, 1e-3)).norm(), 1e-7);
  EXPECT_LT((settle(*proxy, {2e-3, -1.0}).proxy - Vec2(2e-3, -4e-3)).norm(), 1e-7);
  EXPECT_LT((settle(*proxy, {1e3, 1e3}).proxy - Vec2(6e-3, 4e-3)).norm(), 0.5 * kWallPixel);
}

TEST(SubpixelWall, AProxyCaughtBetweenAThinWallAndTheBorderStaysOnItsSide) {
  // The wall's face has a nick there, so sharp that a step along its curve would lead across.
  const double angle = 2.2916;
  const Vec2 off(-0.517e-3, 0.223e-3), t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
  const Walls walls = test::WallPainter(240, 240, kWallPixel)
                          .wall(test::rectangle(off, 1.0, 1.34e-4, angle))
                          .finish(off + 2e-3 * n);
  const auto proxy = make_subpixel_proxy(walls);
  for (double s = -2e-4; s < 1.5e-3; s += 1e-5) {
    const Vec2 along = Vec2(-10.7e-3, 11.7e-3) - s * t;
    const Vec2 face = along + (0.67e-4 - (along - off).dot(n)) * n;
    proxy->start(face + 4e-6 * n);
    proxy->advance(face - 2e-5 * n);
    EXPECT_GT((settle(*proxy, {-9.26e-3, 1.4e-2}).proxy - off).dot(n), 0.0) << s;
  }
}

TEST(SubpixelWall, AProxyRoundsAnIslandTowardTheHand) {
  const Walls walls =
      test::WallPainter(200, 200, kWallPixel).wall_disc(Vec2::Zero(), 3e-3).finish({8e-3, 0.0});
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({8e-3, 0.1e-3});
  const WallContact contact = settle(*proxy, {-5e-3, 0.0});
  EXPECT_FALSE(contact.touching);
  EXPECT_LT((contact.proxy - Vec2(-5e-3, 0.0)).norm(), 1e-12);
}

TEST(SubpixelWall, AProxyLeavesAPocketWhenTheHandDoes) {
  // A dead end to the right of a hall; from its bottom the way back is away from the hand at first.
  const Walls walls = test::WallPainter(300, 200, kWallPixel, false)
                          .open(test::rectangle({-5e-3, 0.0}, 1e-2, 1.6e-2, 0.0))
                          .open(test::rectangle({4e-3, 0.0}, 8.4e-3, 1e-3, 0.0))
                          .finish({-5e-3, 0.0});
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({-5e-3, 0.0});
  EXPECT_NEAR(settle(*proxy, {1.2e-2, 2e-4}).proxy.x(), 8.2e-3, 1e-7);
  // Held by the pocket's upper wall: a true local minimum.
  EXPECT_LT((settle(*proxy, {5e-3, 6e-3}).proxy - Vec2(5e-3, 0.5e-3)).norm(), 1e-7);
  EXPECT_LT((settle(*proxy, {-5e-3, 6e-3}).proxy - Vec2(-5e-3, 6e-3)).norm(), 1e-12);
}

// Found by a property: a wall's tip two pixels thick, where the pixels make a notch in its end
// face. The proxy came to rest in it with a normal that points into the wall.
TEST(SubpixelWall, ANotchInAWallsTipLetsGoOfAProxyWhoseHandLeaves) {
  constexpr double kThick = 2.06691 * kWallPixel, kDeep = 3.459305 * kWallPixel;
  constexpr double kTurn = 0.62228 * 2.0 * M_PI;
  const Vec2 t(std::cos(kTurn), std::sin(kTurn)), n(-t.y(), t.x());
  const Vec2 tip = Vec2(0.733168, -0.577644) * kWallPixel, face = tip + 0.5 * kThick * n;
  const Walls walls = test::WallPainter(240, 240, kWallPixel)
                          .wall(test::rectangle(tip - 4e-3 * t, 8e-3, kThick, kTurn))
                          .finish(tip + 2e-3 * n);
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(face + 1e-3 * n - 4e-4 * t);
  WallContact contact;
  Vec2 hand;
  for (double s = -4e-4; s < 1e-3; s += 2e-5) {
    hand = face - kDeep * n + s * t;
    contact = settle(*proxy, hand);
  }
  EXPECT_LT((contact.proxy - hand).norm(), 1e-9);
}

TEST(SubpixelWall, NoStairOfPixelsHoldsASlidingProxyBack) {
  // A wall almost along the rows steps by a pixel every 60; the greedy search stops at each step.
  const double angle = 1.0 / 60.0;
  const Walls walls = test::straight_wall(1000, kWallPixel, 2e-3, angle, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
  proxy->start(2e-3 * n - 4e-2 * t);
  for (double s = -4e-2; s < 4e-2; s += 5e-3) {  // 5 m/s
    const WallContact contact = proxy->advance(s * t + 0.9999e-3 * n);
    EXPECT_LT((contact.proxy - s * t - 1e-3 * n).norm(), 1e-6);
    EXPECT_FALSE(contact.unfinished);
  }
}

TEST(SubpixelWall, ConcaveCornersOfOnePixelsDepthHoldTheProxyOnlyWhereTheyAreDeepest) {
  // A saw-tooth floor, 1 mm wide and 0.1 mm deep teeth of slope 0.2: half a millimetre under it the
  // hand leaves a tooth's bottom after 0.1 mm, and no ridge holds.
  test::Polygon room = {{1.6e-2, 6e-3}, {-1.6e-2, 6e-3}};
  for (int i = -32; i <= 32; ++i) room.push_back({i * 5e-4, i % 2 == 0 ? 0.0 : -1e-4});
  const Walls walls = test::WallPainter(400, 200, kWallPixel, false).open(room).finish({0.0, 3e-3});
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({-1.4e-2, 3e-3});
  for (double x = -1.4e-2; x < 1.4e-2; x += 1e-4) {
    const WallContact contact = settle(*proxy, {x, -5e-4});
    ASSERT_FALSE(contact.unfinished);
    EXPECT_LT(std::abs(contact.proxy.x() - x), 1.3e-4) << x;
  }
}

TEST(SubpixelWall, AHandInsideAWallStartsTheProxyAtTheNearestFreePoint) {
  const Walls walls = test::straight_wall(300, kWallPixel, 6e-3, 0.4, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 t(std::cos(0.4), std::sin(0.4)), n(-t.y(), t.x());
  EXPECT_LT((proxy->start(1e-3 * t - 1e-3 * n) - (1e-3 * t - 3e-3 * n)).norm(), 1e-6);
}

TEST(SubpixelWall, AHandFarInsideAWallStartsTheProxyAtTheScenesStart) {
  const Walls walls = test::straight_wall(600, kWallPixel, 2e-2, 0.4, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  EXPECT_LT((proxy->start(Vec2::Zero()) - walls.start).norm(), 1e-12);
}

TEST(SubpixelWall, AHandThatIsNotFiniteHasNotMoved) {
  const Walls walls = test::straight_wall(100, kWallPixel, 1e-3, 0.0, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({0.0, 2e-3});
  const Vec2 before = settle(*proxy, {1e-3, 0.0}).proxy;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const WallContact contact = proxy->advance({bad, 0.0});
    EXPECT_TRUE(contact.touching);
    EXPECT_EQ(contact.proxy, before);
  }
  // Nor does the next one start from there.
  EXPECT_LT((settle(*proxy, {2e-3, 0.0}).proxy - Vec2(2e-3, 0.5e-3)).norm(), 1e-6);
}

TEST(SubpixelWall, AdvanceDoesBoundedWorkAndCarriesOnNextTick) {
  const Walls walls = test::straight_wall(4000, kWallPixel, 2e-4, 0.2, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  const Vec2 t(std::cos(0.2), std::sin(0.2)), n(-t.y(), t.x());
  proxy->start(-0.15 * t + 1e-3 * n);
  settle(*proxy, -0.15 * t);
  int ticks = 0;
  WallContact contact;
  do {
    contact = proxy->advance(0.15 * t);
    EXPECT_LE(contact.work, kMostWork);
  } while (contact.unfinished && ++ticks < 1000);
  EXPECT_GT(ticks, 5);
  EXPECT_LT((contact.proxy - 0.15 * t - 1e-4 * n).norm(), 1e-6);
}

TEST(SubpixelWall, AdvanceAllocatesNothing) {
  const Walls walls = test::straight_wall(200, kWallPixel, 2e-4, 0.2, 0.0);
  const auto proxy = make_subpixel_proxy(walls);
  test::NoAllocation guard("advance, start and set_gone");
  for (int i = 0; i < 1000; ++i) proxy->advance({0.01 * std::sin(i), 0.01 * std::cos(1.7 * i)});
  proxy->start(Vec2::Zero());
  proxy->set_gone(0);
}

// A plate of wall 1 with a door, region 2, across the middle of it.
Walls plate_with_door() {
  test::WallPainter painter(200, 200, kWallPixel);
  const std::uint8_t door = painter.add_region("door", RegionKind::kWall);
  Walls walls = painter.wall(test::rectangle(Vec2::Zero(), 2e-2, 1e-3, 0.0)).finish({0.0, 5e-3});
  CoverageMap map = *walls.map;
  for (std::size_t i = 0; i < map.wall.size(); ++i) {
    if (i % 200 >= 80 && i % 200 < 120) map.wall[i] = door;
  }
  walls.map = std::make_shared<const CoverageMap>(std::move(map));
  walls.stages.emplace_back().name = "open";
  walls.stages.back().gone = {door};
  return walls;
}

TEST(SubpixelWall, TheTouchedWallAndTheRegionAreTheProxys) {
  const Walls walls = plate_with_door();
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({0.0, 2e-3});
  const WallContact on_door = settle(*proxy, Vec2::Zero());
  EXPECT_EQ(on_door.wall, 2);
  EXPECT_EQ(on_door.region, 0);
  EXPECT_EQ(settle(*proxy, {5e-3, 0.0}).wall, 1);
}

TEST(SubpixelWall, AWallThatIsGoneLetsTheHandThroughAndHoldsItWhenBack) {
  const Walls walls = plate_with_door();
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start({0.0, 2e-3});
  EXPECT_NEAR(settle(*proxy, {0.0, -3e-3}).proxy.y(), 0.5e-3, 1e-7);
  proxy->set_gone(1u << 2);
  EXPECT_LT((settle(*proxy, {0.0, -3e-3}).proxy - Vec2(0.0, -3e-3)).norm(), 1e-12);
  // Its jambs are wall still.
  EXPECT_LT((settle(*proxy, {1e-3, -1e-4}).proxy - Vec2(1e-3, -1e-4)).norm(), 1e-12);
  EXPECT_NEAR(settle(*proxy, {3e-3, -1e-4}).proxy.x(), 2e-3, 0.1 * kWallPixel);
  EXPECT_LT((settle(*proxy, {0.0, -1e-4}).proxy - Vec2(0.0, -1e-4)).norm(), 1e-12);
  proxy->set_gone(0);
  EXPECT_NEAR(settle(*proxy, {0.0, -1e-4}).proxy.y(), -0.5e-3, 1e-7);
}

TEST(SubpixelWall, AnEvenMapWithoutAPaintedImageIsRefused) {
  EXPECT_THROW(make_subpixel_proxy(Walls()), std::invalid_argument);
}

}  // namespace
}  // namespace handrail
