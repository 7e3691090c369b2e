#include "server/constraint/drawn/exact_wall.h"
#include "server/haptic/wall_proxies.h"

#include <gtest/gtest.h>

#include "tests/support/no_allocation.h"
#include "tests/unit/constraint_drawn/shape_samples.h"

namespace handrail {
namespace {

using namespace test;

constexpr double kExact = 1e-12;  // [m]

// One tick from `from` to `to`.
WallContact move(const Walls& walls, const Vec2& from, const Vec2& to) {
  const auto proxy = make_wall_proxy(walls);
  proxy->start(from);
  return proxy->advance(to);
}

void expect_at(const WallContact& contact, const Vec2& p, const Vec2& normal) {
  EXPECT_TRUE(contact.touching);
  EXPECT_FALSE(contact.unfinished);
  EXPECT_NEAR(contact.proxy.x(), p.x(), kExact);
  EXPECT_NEAR(contact.proxy.y(), p.y(), kExact);
  EXPECT_NEAR(contact.normal.x(), normal.x(), 1e-9);
  EXPECT_NEAR(contact.normal.y(), normal.y(), 1e-9);
}

TEST(ExactWall, AFreeHandIsItsOwnProxy) {
  const WallContact contact = move(crossing(), {0, 0}, {0.03, 0.004});
  EXPECT_EQ(contact.proxy, Vec2(0.03, 0.004));
  EXPECT_FALSE(contact.touching);
  EXPECT_EQ(contact.normal, Vec2(0, 0));
}

TEST(ExactWall, BehindAStraightWallTheProxyIsTheFootAtAnyAngle) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const double angle = degrees * kQuarter / 90.0;
    const Pose2 pose{{0.01, -0.02}, angle};
    const Walls walls = drawn({box(pose.p, {0.05, 0.005}, angle)});
    for (const double depth : {1e-9, 1e-4, 1e-3, 0.02}) {
      const WallContact contact = move(walls, pose.p, pose.to_world({0.0123, 0.005 + depth}));
      expect_at(contact, pose.to_world({0.0123, 0.005}), Pose2::turned({0, -1}, angle));
    }
  }
}

TEST(ExactWall, BehindARoundWallTheProxyIsTheFootInsideAndOutside) {
  const Walls walls = drawn({ring({0.01, 0.02}, 0.02, 0.004)});
  for (int degrees = 3; degrees < 360; degrees += 11) {
    const Vec2 u = Pose2::turned(Vec2::UnitX(), degrees * kQuarter / 90.0);
    const Vec2 c(0.01, 0.02);
    expect_at(move(walls, c + 0.02 * u, c + 0.025 * u), c + 0.022 * u, -u);
    expect_at(move(walls, c + 0.02 * u, c + 0.012 * u), c + 0.018 * u, u);
  }
}

TEST(ExactWall, AHandThatWasOnTheBorderToTheLastBitIsHeldWhenItGoesIn) {
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double angle = degrees * kQuarter / 90.0;
    const Pose2 pose{{0.0123, -0.0234}, angle};
    const Walls lane = drawn({box(pose.p, {0.05, 0.005}, angle)});
    const auto straight = make_exact_proxy(lane);
    straight->start(pose.to_world({0.01, 0}));
    straight->advance(pose.to_world({0.0101, 0.005}));
    expect_at(straight->advance(pose.to_world({0.0102, 0.006})), pose.to_world({0.0102, 0.005}),
              Pose2::turned({0, -1}, angle));
    const Walls loop = drawn({ring(pose.p, 0.02, 0.004)});
    for (const double side : {1.0, -1.0}) {
      const auto round = make_exact_proxy(loop);
      round->start(pose.to_world({0.02, 0}));
      round->advance(pose.to_world({0.02 + 0.002 * side, 0}));
      expect_at(round->advance(pose.to_world({0.02 + 0.003 * side, 0})),
                pose.to_world({0.02 + 0.002 * side, 0}), Pose2::turned({-side, 0}, angle));
    }
  }
}

TEST(ExactWall, AlongARoundWallTheProxyFollowsTheHandsAngle) {
  const Walls walls = drawn({ring({0, 0}, 0.02, 0.004)});
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0.02, 0});
  for (int i = 0; i <= 3600; ++i) {
    const Vec2 u = Pose2::turned(Vec2::UnitX(), i * kQuarter / 900.0);
    const double depth = i % 2 == 0 ? 0.0175 : 0.023;
    expect_at(proxy->advance(depth * u), (i % 2 == 0 ? 0.018 : 0.022) * u, i % 2 == 0 ? u : -u);
  }
}

TEST(ExactWall, InARoomsCornerTheProxyIsTheCorner) {
  const WallContact contact = move(drawn({box({0, 0}, {0.01, 0.01})}), {0, 0}, {0.013, 0.014});
  expect_at(contact, {0.01, 0.01}, Vec2(-3, -4).normalized());
}

TEST(ExactWall, AHandBehindAnAcuteWallTipIsHeldAtTheSideItCameFrom) {
  // Two lanes at 30 degrees; between them a wall that ends in a tip.
  const double angle = kQuarter / 3.0;
  const Walls walls = drawn({box({0, 0}, {0.1, 0.002}), box({0, 0}, {0.1, 0.002}, angle)});
  const double tip = 0.002 / std::tan(angle / 2.0);
  const Vec2 beside = Vec2(tip, 0.002) + 0.01 * Vec2(std::cos(angle / 2), std::sin(angle / 2));
  // From the lower lane the foot is on its border, from the slanting lane on that one's.
  expect_at(move(walls, {beside.x(), 0}, beside), {beside.x(), 0.002}, {0, -1});
  const Vec2 n = Pose2::turned({0, 1}, angle);
  const Vec2 lane = beside.dot(Pose2::turned({1, 0}, angle)) * Pose2::turned({1, 0}, angle);
  expect_at(move(walls, lane, beside), lane - 0.002 * n, n);
}

TEST(ExactWall, PushedBackAgainstATipTheProxyStaysOnIt) {
  const Walls walls = crossing();
  // The wall's corner at (5, 5) mm; the hand in the wall behind it leaves by the nearer side.
  expect_at(move(walls, {0.005, 0.005}, {0.009, 0.006}), {0.009, 0.005}, {0, -1});
  expect_at(move(walls, {0.005, 0.005}, {0.006, 0.009}), {0.005, 0.009}, {-1, 0});
}

TEST(ExactWall, TheProxyGoesAroundACornerThatTheHandCutsAcross) {
  const Walls walls = crossing();
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0.04, 0});
  // Through the wall's quadrant: held at the lane's border, then free in the other lane.
  expect_at(proxy->advance({0.03, 0.01}), {0.03, 0.005}, {0, -1});
  expect_at(proxy->advance({0.0051, 0.03}), {0.0051, 0.005}, {0, -1});
  EXPECT_EQ(proxy->advance({0.0049, 0.03}).proxy, Vec2(0.0049, 0.03));
  expect_at(proxy->advance({0.03, 0.01}), {0.005, 0.01}, {-1, 0});
}

TEST(ExactWall, AHandPastARoundWallIsReachedAroundIt) {
  // Around the ring's inner wall and off it along the tangent.
  const Walls walls = drawn({ring({0, 0}, 0.02, 0.004), box({-0.03, 0}, {0.012, 0.02})});
  const Vec2 far(-0.03, 0.001);
  const WallContact contact = move(walls, {0.018, 0.002}, far);
  EXPECT_FALSE(contact.touching);
  EXPECT_EQ(contact.proxy, far);
}

TEST(ExactWall, FromTheFarthestPointOfARoundWallItStillGoesAround) {
  const Walls walls = drawn({ring({0, 0}, 0.02, 0.004)});
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0.018, 0});
  expect_at(proxy->advance({1e-5, 0}), {0.018, 0}, {1, 0});
  expect_at(proxy->advance({0, 0}), {0.018, 0}, {1, 0});
  expect_at(proxy->advance({-1e-5, 0}), {-0.018, 0}, {-1, 0});
}

TEST(ExactWall, AHandThatJumpsAcrossAThinWallLeavesItsProxyBehind) {
  const Walls walls = drawn({box({0, 0}, {0.05, 0.005}), box({0, 0.01001}, {0.05, 0.005}),
                             ring({0, 0}, 0.1, 0.01), ring({0, 0}, 0.11001, 0.01)});
  expect_at(move(walls, {0, 0}, {0.01, 0.0123}), {0.01, 0.005}, {0, -1});
  expect_at(move(walls, {0, 0}, {0.01, 10.0}), {0.01, 0.005}, {0, -1});
  expect_at(move(walls, {0, 0.011}, {0.01, -0.001}), {0.01, 0.00501}, {0, 1});
  expect_at(move(walls, {0.1, 0}, {0.11, 0}), {0.105, 0}, {-1, 0});
  expect_at(move(walls, {0.11, 0}, {0.09, 0}), {0.10501, 0}, {1, 0});
}

TEST(ExactWall, AHandBeyondEverythingIsHeldAtTheBorder) {
  const WallContact contact = move(crossing(), {0, 0}, {1e6, 0.001});
  expect_at(contact, {0.05, 0.001}, {-1, 0});
}

TEST(ExactWall, ANotchFarBelowAnyPixelIsFollowedIntoItsCornerAndLeftWhenTheWayOutLeadsNearer) {
  // 10 um wide and deep in the lane's border.
  const Walls walls = drawn({box({0, 0}, {0.05, 0.005}), box({0, 0.005}, {5e-6, 1e-5})});
  const auto proxy = make_exact_proxy(walls);
  proxy->start({-0.01, 0});
  expect_at(proxy->advance({-0.001, 0.006}), {-0.001, 0.005}, {0, -1});
  expect_at(proxy->advance({0, 0.006}), {0, 0.00501}, {0, -1});
  // Its corner is a true local minimum for a hand above the notch, however far aside.
  const Vec2 corner(5e-6, 0.00501);
  expect_at(proxy->advance({0.01, 0.006}), corner, (corner - Vec2(0.01, 0.006)).normalized());
  expect_at(proxy->advance({0.01, 0.005005}), {5e-6, 0.005005}, {-1, 0});
  EXPECT_FALSE(proxy->advance({0.01, 0.004999}).touching);
}

TEST(ExactWall, TheRegionIsThatOfTheLastShapeTheProxyIsIn) {
  const Walls walls = drawn({box({0, 0}, {0.05, 0.005}), in_region(disc({0.05, 0}, 0.007), 1)});
  EXPECT_EQ(move(walls, {0, 0}, {0.042, 0}).region, 0);
  EXPECT_EQ(move(walls, {0, 0}, {0.044, 0}).region, 1);
  EXPECT_EQ(move(walls, {0, 0}, {0.1, 0}).region, 1);
  EXPECT_EQ(move(walls, {0, 0}, {0, 0.1}).region, 0);
  EXPECT_EQ(move(walls, {0, 0}, {0, 0.1}).wall, 2);
}

TEST(ExactWall, WhileTheWallIsGoneEverythingIsFree) {
  const Walls walls = crossing();
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0, 0});
  proxy->set_gone(1u << 2);
  const WallContact contact = proxy->advance({0.02, 0.03});
  EXPECT_EQ(contact.proxy, Vec2(0.02, 0.03));
  EXPECT_FALSE(contact.touching);
  EXPECT_EQ(contact.region, 2);
}

TEST(ExactWall, AWallThatComesBackPutsTheProxyToTheNearestFreePoint) {
  const auto walls = crossing();
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0, 0});
  proxy->set_gone(1u << 2);
  proxy->advance({0.03, 0.009});
  proxy->set_gone(1u << 1);
  expect_at(proxy->advance({0.03, 0.009}), {0.03, 0.005}, {0, -1});
  proxy->set_gone(1u << 2);
  proxy->advance({0.02, 0.001});
  proxy->set_gone(0);
  EXPECT_EQ(proxy->advance({0.02, 0.001}).proxy, Vec2(0.02, 0.001));
}

TEST(ExactWall, AHandThatStartsInsideTheWallIsPutNearByOrToTheScenesStart) {
  const auto walls = crossing();
  const auto proxy = make_exact_proxy(walls);
  EXPECT_EQ(proxy->start({0.03, 0.001}), Vec2(0.03, 0.001));
  EXPECT_LT((proxy->start({0.03, 0.0099}) - Vec2(0.03, 0.005)).norm(), kExact);
  EXPECT_EQ(proxy->start({0.03, 0.0101}), walls.start);
  EXPECT_EQ(proxy->start({NAN, 0.0}), walls.start);
}

TEST(ExactWall, AHandThatIsNotFiniteCountsAsOneThatHasNotMoved) {
  const auto walls = crossing();
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0.03, 0});
  proxy->advance({0.03, 0.007});
  for (const double bad : {double(NAN), double(INFINITY)}) {
    expect_at(proxy->advance({0.0, bad}), {0.03, 0.005}, {0, -1});
    expect_at(proxy->advance({bad, 0.0}), {0.03, 0.005}, {0, -1});
  }
}

TEST(ExactWall, MorePiecesThanATickAllowsAreFinishedInTheNext) {
  const auto walls = stairs(200);
  const auto proxy = make_exact_proxy(walls);
  proxy->start({0, 0});
  const Vec2 hand(0.1995, 0.008);
  WallContact contact = proxy->advance(hand);
  EXPECT_TRUE(contact.unfinished);
  double last = 0.0;
  int ticks = 1;
  for (; contact.unfinished && ticks < 300; ++ticks) {
    EXPECT_GT(contact.proxy.x(), last);
    EXPECT_LE(contact.work, 2048 + 1000);
    last = contact.proxy.x();
    contact = proxy->advance(hand);
  }
  EXPECT_GT(ticks, 2);
  EXPECT_LT(ticks, 300);
  expect_at(contact, {0.1995, 0.00399}, {0, -1});
}

TEST(ExactWall, StepsDoNotTouchTheHeap) {
  const auto walls = gear_lanes(0.002);
  const auto proxy = make_exact_proxy(walls);
  NoAllocation guard("a step of the exact proxy");
  proxy->start({0, 0});
  for (int i = 0; i < 5000; ++i) {
    proxy->advance(Vec2(0.06 * std::sin(0.37 * i), 0.05 * std::cos(0.23 * i)));
    if (i % 500 == 0) proxy->set_gone(i % 1000 == 0 ? 4u : 0u);
  }
}

TEST(ExactWall, NeedsShapes) { EXPECT_THROW(make_exact_proxy(Walls()), std::invalid_argument); }

}  // namespace
}  // namespace handrail
