// Each choice against what is known of it: errors fall as settings get finer. Times are not judged.
#include "server/lab/accuracy/choices.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "server/lab/accuracy/wall_choice.h"
#include "server/lab/accuracy/wall_course.h"

namespace handrail {
namespace {

const std::atomic<bool> kGoOn = false;

AccuracyRows of(const AccuracyRows& rows, const std::string& method) {
  AccuracyRows out;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(out),
               [&](const AccuracyRow& row) { return row.method == method; });
  return out;
}

void expect_falling(const AccuracyRows& rows, double slack = 1.0) {
  ASSERT_GT(rows.size(), 1u);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_LT(rows[i].error.rms, slack * rows[i - 1].error.rms)
        << rows[i].method << " " << rows[i].setting;
  }
}

void expect_whole(const AccuracyRows& rows, const std::string& choice) {
  ASSERT_FALSE(rows.empty());
  for (const AccuracyRow& row : rows) {
    EXPECT_EQ(row.choice, choice);
    EXPECT_FALSE(row.method.empty() || row.setting.empty());
    EXPECT_FALSE(row.error.unit.empty() || row.cost.unit.empty());
    EXPECT_TRUE(std::isfinite(row.error.worst) && row.error.worst >= row.error.rms) << row.setting;
    EXPECT_TRUE(std::isfinite(row.cost.p999) && row.cost.p999 >= row.cost.median) << row.setting;
    EXPECT_GT(row.memory_bytes, 0u);
  }
}

TEST(WallCourses, KeepTheirFootOnTheWallAndTheHandAMillimetreBehindIt) {
  for (const WallCourse& course : wall_courses()) {
    for (double way = 0.0; way < 3.0 * course.length; way += 0.37e-3) {
      const Vec2 hand = course.hand(way), foot = course.foot(way);
      EXPECT_NEAR((hand - foot).norm(), kCourseDepth, 1e-12);
      EXPECT_NEAR(course.off_surface(foot), 0.0, 1e-12);
      EXPECT_NEAR(course.off_surface(hand), -kCourseDepth, 1e-12);
      EXPECT_NEAR(course.off_surface(course.free_at(way)), kCourseDepth, 1e-12);
    }
  }
}

TEST(WallAccuracy, MethodsOrderAsTheirPrinciplesSay) {
  std::vector<WallSetting> settings;
  for (const double pixel : {0.4e-3, 0.2e-3, 0.1e-3}) {
    settings.push_back({WallMethod::kPublished, pixel, 2.5});
    settings.push_back({WallMethod::kSubpixel, pixel, 0.0});
  }
  settings.push_back({WallMethod::kExact, 0.0, 0.0});
  const AccuracyRows rows = wall_rows(settings, kGoOn);
  expect_whole(rows, "wall");
  const AccuracyRows published = of(rows, "published"), subpixel = of(rows, "subpixel");
  expect_falling(published);
  expect_falling(subpixel);
  for (std::size_t i = 0; i < published.size(); ++i) {
    EXPECT_GT(published[i].error.rms, 30.0 * subpixel[i].error.rms) << published[i].setting;
  }
  // Algorithm 1 stays behind on the walls it grazes, whatever the pixel; the others do not.
  EXPECT_GT(published[2].whole.worst, 300.0);
  EXPECT_THAT(published[2].note, ::testing::HasSubstr("behind"));
  EXPECT_LT(subpixel[2].whole.worst, 1e3 * std::tan(0.0175));  // 1 deg, 1 mm deep
  EXPECT_EQ(subpixel[2].note, "");
  // Half a pixel's diagonal at most, on the average a third of a pixel.
  EXPECT_NEAR(published[2].error.rms, 25.0, 15.0);
  EXPECT_LT(rows.back().error.worst, 1e-6);
  EXPECT_EQ(published[2].setting, "pixel 0.1 mm, radius 2.5 px");
}

TEST(WallAccuracy, ListsEveryPixelWithEveryMethod) {
  const std::vector<WallSetting> settings = wall_settings();
  EXPECT_EQ(settings.size(), 5u * 4u + 1u);
  EXPECT_EQ(describe(settings[3]), "pixel 0.4 mm");
  EXPECT_EQ(describe(settings.back()), "shapes");
  const std::atomic<bool> cancelled = true;
  EXPECT_TRUE(wall_rows(settings, cancelled).empty());
}

TEST(ToolAccuracy, FinerStepsComeNearerAndTheClosedFormIsExact) {
  const AccuracyRows rows = tool_rows(kGoOn);
  expect_whole(rows, "tool_step");
  AccuracyRows published = of(rows, "published");
  EXPECT_EQ(published.size(), 10u);
  // With steps of 1 um the most steps of a tick are not enough, and the row says so.
  EXPECT_GT(published.back().error.worst, 1e3);
  EXPECT_THAT(published.back().note, ::testing::HasSubstr("keep up"));
  published.pop_back();
  expect_falling(published);
  // Steps end within one step of the foot.
  EXPECT_LT(published[0].error.worst, 1.5e3);
  EXPECT_LT(published.back().error.worst, 3.0);
  EXPECT_EQ(rows.back().error.worst, 0.0);
}

TEST(SmootherAccuracy, LongerMeansLagByHalfTheirLength) {
  const AccuracyRows rows = smoother_rows();
  expect_whole(rows, "smoother");
  EXPECT_NEAR(rows[0].error.rms, 50.0, 5.0);  // the tremor itself
  for (const AccuracyRow& row : rows) {
    const double length = std::stod(row.setting);
    if (length > 300.0) continue;  // then the reach is no longer slow beside it
    EXPECT_NEAR(row.cost.median, 0.5 * (length - 1.0), 0.02 * length + 0.01) << row.setting;
  }
  const auto published = std::find_if(rows.begin(), rows.end(), [](const AccuracyRow& row) {
    return row.setting == "200 samples (published)";
  });
  ASSERT_NE(published, rows.end());
  EXPECT_LT(published->error.rms, 0.2 * rows[0].error.rms);
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_LT(rows[i].error.rms, rows[0].error.rms);
}

TEST(IntegratorAccuracy, EverySchemeConvergesAndFourthOrderIsAheadAtFineSteps) {
  const AccuracyRows rows = integrator_rows(kGoOn);
  expect_whole(rows, "integrator");
  for (const char* method :
       {"explicit Euler", "symplectic Euler", "implicit Euler", "Runge-Kutta 4", "hand model"}) {
    const AccuracyRows some = of(rows, method);
    ASSERT_GE(some.size(), 4u) << method;
    EXPECT_LT(some.back().error.rms, 0.2 * some.front().error.rms) << method;
    EXPECT_LT(some.back().error.rms, 20.0) << method;
  }
  EXPECT_LT(of(rows, "Runge-Kutta 4").back().error.rms,
            0.2 * of(rows, "symplectic Euler").back().error.rms);
}

TEST(RateAccuracy, FasterLoopsComeNearerToAContinuousWall) {
  const AccuracyRows rows = rate_rows(kGoOn);
  expect_whole(rows, "haptic_rate");
  expect_falling(rows);
  EXPECT_EQ(rows.front().setting, "250 Hz");
  EXPECT_EQ(rows.back().setting, "10000 Hz");
  EXPECT_LT(rows.back().error.rms, 0.1 * rows.front().error.rms);
}

TEST(LinkAccuracy, SlowerDatagramsLeaveTheCommandFurtherBehind) {
  const AccuracyRows rows = link_rows(kGoOn);
  expect_whole(rows, "link_rate");
  // A 25 Hz command is half of 40 ms late on the average, the tip at up to 78 mm/s.
  EXPECT_GT(rows.front().error.rms, 500.0);
  EXPECT_LT(rows.front().error.worst, 40e-3 * 78.2e-3 * 1e6);
  EXPECT_LT(rows.back().error.worst, 0.5e-3 * 78.2e-3 * 1e6 * 1.01);
  expect_falling(rows, 1.05);
  EXPECT_GT(rows.back().cost.median, rows.front().cost.median);
}

}  // namespace
}  // namespace handrail
