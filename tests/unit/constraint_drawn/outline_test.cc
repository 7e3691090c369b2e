// How shapes join: the border of their union and its fillets.
#include "server/constraint/drawn/outline.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/constraint_drawn/shape_samples.h"

namespace handrail {
namespace {

using namespace test;

// Of a point outside, negative inside the wall [m].
double signed_distance(const Outline& outline, const Vec2& x) {
  const Outline::Place near = outline.nearest(x);
  const double d = (near.p - x).norm();
  return outline.is_free(x, near) ? d : -d;
}

double border_length(const Outline& outline) {
  double sum = 0.0;
  for (int i = 0; i < outline.size(); ++i) sum += outline.piece(i).size();
  return sum;
}

// Every piece ends exactly where the next starts, and every corner is followed once.
void expect_closed(const Outline& outline) {
  std::vector<int> followed(static_cast<std::size_t>(outline.size()), 0);
  for (int i = 0; i < outline.size(); ++i) {
    EXPECT_EQ(outline.piece(i).b, outline.piece(outline.next(i)).a);
    EXPECT_EQ(outline.before(outline.next(i)), i);
    ++followed[static_cast<std::size_t>(outline.next(i))];
  }
  for (const int times : followed) EXPECT_EQ(times, 1);
}

TEST(Outline, AShapesBorderHasItsLength) {
  const double pi = 2.0 * kQuarter;
  EXPECT_NEAR(border_length(Outline({box({0, 0}, {0.02, 0.01}, 0.3)}, 0.0)), 0.12, 1e-12);
  EXPECT_NEAR(border_length(Outline({disc({0, 0}, 0.01)}, 0.0)), 0.02 * pi, 1e-12);
  EXPECT_NEAR(border_length(Outline({ring({0, 0}, 0.01, 0.004)}, 0.0)), 0.04 * pi, 1e-12);
  EXPECT_NEAR(border_length(Outline({arc_aisle({0, 0}, 0.01, 0.004, 0.5, 4.5)}, 0.0)),
              0.008 + 0.02 * 4.0, 1e-12);
  // As wide as to reach its centre: a slice of a disc.
  EXPECT_NEAR(border_length(Outline({arc_aisle({0, 0}, 0.005, 0.01, 0.0, 1.0)}, 0.0)), 0.03, 1e-12);
}

TEST(Outline, ShapesSideBySideAreJoinedWithoutAWall) {
  for (const double angle : {0.0, 0.1, 1.0, 2.3}) {
    const Pose2 pose{{0.013, 0.007}, angle};
    for (const double gap : {0.0, 1e-15, -1e-15, 1e-10, -1e-10}) {
      const Outline outline({box(pose.to_world({-0.02, 0}), {0.02, 0.005}, angle),
                             box(pose.to_world({0.02 + gap, 0}), {0.02, 0.005}, angle)},
                            0.0);
      expect_closed(outline);
      EXPECT_NEAR(border_length(outline), 0.18, 1e-8);
      EXPECT_NEAR(signed_distance(outline, pose.p), 0.005, 1e-8);
    }
  }
}

TEST(Outline, ShapesSideBySideOfDifferentSizeOpenOnlyWhatTheyShare) {
  const Outline outline({box({-0.02, 0}, {0.02, 0.005}), box({0.02, 0.003}, {0.02, 0.005})}, 0.0);
  expect_closed(outline);
  EXPECT_NEAR(border_length(outline), 0.186, 1e-9);
  EXPECT_NEAR(signed_distance(outline, {0.0, -0.001}), 0.001, 1e-9);
  EXPECT_NEAR(signed_distance(outline, {0.001, -0.004}), -0.001, 1e-9);
}

TEST(Outline, BordersOnTopOfEachOtherCountOnce) {
  const WallShape lane = box({0, 0}, {0.02, 0.005}, 0.4);
  const Outline twice({lane, lane, lane}, 0.0);
  expect_closed(twice);
  EXPECT_NEAR(border_length(twice), 0.1, 1e-9);
  const Outline round({disc({0, 0}, 0.01), arc_aisle({0, 0}, 0.008, 0.004, 0.0, 3.0)}, 0.0);
  expect_closed(round);
  EXPECT_NEAR(border_length(round), 0.04 * kQuarter, 1e-9);
  // A lane within a lane, sharing a side.
  const Outline inner({box({0, 0}, {0.02, 0.005}), box({0, 0.003}, {0.01, 0.002})}, 0.0);
  expect_closed(inner);
  EXPECT_NEAR(border_length(inner), 0.1, 1e-9);
}

TEST(Outline, ALaneWithARoundEndIsOneSmoothBorder) {
  const Outline outline({box({0, 0}, {0.02, 0.005}), disc({0.02, 0}, 0.005)}, 0.0);
  expect_closed(outline);
  EXPECT_NEAR(border_length(outline), 0.09 + 0.01 * kQuarter, 1e-8);
  EXPECT_NEAR(signed_distance(outline, {0.027, 0}), -0.002, 1e-9);
  EXPECT_NEAR(signed_distance(outline, {0.02, 0}), 0.005, 1e-9);
}

TEST(Outline, ShapesThatTouchInAPointAreJoinedThere) {
  const Outline outline({disc({-0.01, 0}, 0.01), disc({0.01, 0}, 0.01)}, 0.001);
  expect_closed(outline);
  EXPECT_NEAR(border_length(outline), 0.08 * kQuarter, 1e-9);
  int corner = -1;
  for (int i = 0; i < outline.size(); ++i) {
    if (outline.piece(i).b.norm() < 1e-9) corner = i;
  }
  ASSERT_GE(corner, 0);
  EXPECT_NE(outline.twin(corner), corner);
  EXPECT_TRUE(outline.opens(corner, {1, 0.1}));
  EXPECT_TRUE(outline.opens(corner, {-1, 0.1}));
  EXPECT_FALSE(outline.opens(corner, {0, 1}));
}

// Fillet circles from the two borders' distances alone.
struct FilletCase {
  const char* name;
  std::vector<WallShape> shapes;
  double radius;
  Vec2 centre;
};

std::vector<FilletCase> fillet_cases() {
  const double r = 0.002;
  return {
      {"line and line", crossing().shapes, r, {0.005 + r, 0.005 + r}},
      {"line and arc",
       {disc({0, 0}, 0.01), box({0.015, 0}, {0.015, 0.003})},
       r,
       {std::sqrt(0.012 * 0.012 - 0.005 * 0.005), 0.005}},
      {"arc and arc",
       {disc({-0.007, 0}, 0.01), disc({0.007, 0}, 0.01)},
       r,
       {0.0, std::sqrt(0.012 * 0.012 - 0.007 * 0.007)}},
      {"line and the inside of a ring",
       {ring({0, 0}, 0.02, 0.004), box({0.01, 0}, {0.01, 0.003})},
       r,
       {std::sqrt(0.016 * 0.016 - 0.005 * 0.005), 0.005}},
      {"acute lines",
       {box({0, 0}, {0.1, 0.003}), box({0, 0}, {0.1, 0.003}, kQuarter / 3.0)},
       r,
       0.005 / std::sin(kQuarter / 6.0) * Vec2(std::cos(kQuarter / 6.0), std::sin(kQuarter / 6.0))},
  };
}

TEST(Outline, AFilletIsTheCircleThatTouchesBothBorders) {
  for (const FilletCase& one : fillet_cases()) {
    SCOPED_TRACE(one.name);
    const Outline outline(one.shapes, one.radius);
    expect_closed(outline);
    int found = 0;
    for (int i = 0; i < outline.size(); ++i) {
      const OutlinePiece& piece = outline.piece(i);
      const bool is_fillet = piece.turn < 0 && std::abs(piece.radius - one.radius) < 1e-12;
      found += is_fillet && (piece.centre - one.centre).norm() < 1e-9;
      // No corner that protrudes into free space is left.
      const OutlinePiece& next = outline.piece(outline.next(i));
      EXPECT_GT(cross(piece.tangent(piece.b), next.tangent(next.a)), -1e-6);
    }
    EXPECT_EQ(found, 2) << "its two halves";
  }
}

TEST(Outline, AFilletTooLargeForItsBordersIsTheLargestThatFits) {
  // A wall post of 4 x 4 mm in a loop of lanes becomes round.
  const double out = 0.006, half = 0.004;
  const Outline outline({box({-out, 0}, {half, 0.01}), box({out, 0}, {half, 0.01}),
                         box({0, -out}, {0.01, half}), box({0, out}, {0.01, half})},
                        0.01);
  expect_closed(outline);
  for (const double angle : {0.1, 0.9, 2.0, 4.0}) {
    const Vec2 u = Pose2::turned(Vec2::UnitX(), angle);
    EXPECT_NEAR(signed_distance(outline, 0.003 * u), 0.001, 1e-6);
  }
}

TEST(Outline, WithoutFilletCornersStaySharp) {
  const Outline outline(crossing(0.0).shapes, 0.0);
  EXPECT_EQ(outline.size(), 12);
  EXPECT_NEAR(signed_distance(outline, {0.005 - 1e-4, 0.005 - 1e-4}), 1e-4 * std::sqrt(2), 1e-12);
}

// Points all over random unions: the same side as the shapes say, and no border nearer.
TEST(Outline, AgreesWithTheShapesEverywhere) {
  std::mt19937_64 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int scene = 0; scene < 300; ++scene) {
    std::vector<WallShape> shapes;
    for (int i = 0; i < 1 + scene % 7; ++i) {
      const Vec2 c(between(-0.03, 0.03), between(-0.03, 0.03));
      const int kind = static_cast<int>(between(0, 3));
      const double from = between(-7, 7);
      shapes.push_back(kind == 0   ? box(c, {between(1e-3, 0.03), between(1e-3, 0.01)}, from)
                       : kind == 1 ? disc(c, between(1e-3, 0.02))
                                   : arc_aisle(c, between(0.004, 0.02), between(1e-3, 0.012), from,
                                               from + between(0.1, 7.0)));
    }
    const Walls walls = drawn(shapes);
    const Outline outline(shapes, 0.0);
    expect_closed(outline);
    for (int i = 0; i < 300; ++i) {
      const Vec2 x(between(-0.06, 0.06), between(-0.06, 0.06));
      const double d = signed_distance(outline, x);
      if (std::abs(d) < 1e-8) continue;
      ASSERT_EQ(d > 0.0, holds(walls, x, 0.0)) << "scene " << scene << " at " << x.transpose();
      // Within |d| of x everything is on x's side; a little further something is not.
      bool met = false;
      for (int k = 0; k < 24; ++k) {
        const Vec2 u = Pose2::turned(Vec2::UnitX(), k * kQuarter / 6.0);
        ASSERT_EQ(holds(walls, x + 0.999 * std::abs(d) * u, 0.0), d > 0.0) << "scene " << scene;
      }
      const Vec2 to = outline.nearest(x).p - x;
      met = holds(walls, x + (1.0 + 1e-6 / std::abs(d)) * to, 0.0) != (d > 0.0);
      ASSERT_TRUE(met || outline.nearest(x).corner >= 0) << "scene " << scene;
    }
  }
}

}  // namespace
}  // namespace handrail
