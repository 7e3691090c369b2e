#include "server/lab/scenes/press_course.h"

#include <gtest/gtest.h>

#include "server/kinematics/rv2a.h"
#include "server/scene/scene_io.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

Scene scene_of(const std::string& simulate) {
  const auto scene = parse_scene("/x/a.scene", "name: 'a' simulate { " + simulate + " }");
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene ? *scene : Scene();
}

const char kCompliance[] = "effect { arm_compliance { n_mm: 60 } } ";
const char kFloor[] = "effect { plane { at_mm: [0, 0, 300] normal: [0, 0, 1] } } ";
const char kSocket[] =
    "effect { hex_socket { at_mm: [400, 50, 250] axis: [0.1, 0, 1] } } effect { screw_thread {} } ";

PressResult press(const std::string& simulate) {
  const Scene scene = scene_of(simulate);
  const auto course = press_course(scene);
  EXPECT_TRUE(course.is_ok()) << course.message();
  return course ? run_press(scene, *course) : PressResult();
}

TEST(PressCourse, GoesAMillimetreIntoAPlaneAndEndsWhereItBegan) {
  const auto course = press_course(scene_of(kFloor));
  ASSERT_TRUE(course) << course.message();
  double lowest = 1.0;
  for (std::size_t i = 0; i < course->q.size(); ++i) {
    const Pose X = forward(ArmGeometry(), course->q[i]);
    ASSERT_LT((X.p - course->X_ST[i].p).norm(), 1e-9);
    ASSERT_NEAR((X.q * Vec3::UnitZ()).z(), -1.0, 1e-9) << "the tool points at it";
    lowest = std::min(lowest, X.p.z());
    if (i == 0) continue;
    ASSERT_LT((course->X_ST[i].p - course->X_ST[i - 1].p).norm(), 0.2e-3);
    ASSERT_LT((course->q[i] - course->q[i - 1]).norm(), 0.02);
  }
  EXPECT_NEAR(lowest, 0.299, 1e-9);
  EXPECT_LT((course->q.front() - course->q.back()).norm(), 0.02);
}

TEST(PressCourse, TheForceIsThatOfTheSpringsInSeries) {
  const PressResult r = press(kCompliance + std::string(kFloor));
  EXPECT_NEAR(r.peak, 1e-3 / (1.0 / 60e3 + 1e-6), 3.0) << "and friction";
  EXPECT_GT(r.mean, 0.5 * r.peak);
  EXPECT_LT(r.sensor_off, 1e-5) << "an ideal sensor";
  EXPECT_GT(r.read_off, 0.1e-3) << "encoders do not see the arm bend";
  EXPECT_EQ(r.screw, 0.0);
}

TEST(PressCourse, TouchesWhateverIsListed) {
  for (const char* thing :
       {"effect { box { at_mm: [400, 0, 250] size_mm: [60, 60, 60] turn_deg: [0, 0, 20] } }",
        "effect { cylinder { at_mm: [400, 0, 250] axis: [0, 1, 0] radius_mm: 30 length_mm: 90 } }",
        "effect { cylinder { at_mm: [380, 0, 300] axis: [0, 0, 1] radius_mm: 10 length_mm: 40"
        " hole: true } }"}) {
    const PressResult r = press(kCompliance + std::string(thing));
    EXPECT_NEAR(r.peak, 1e-3 / (1.0 / 60e3 + 1e-6), 4.0) << thing;
  }
}

TEST(PressCourse, TurnsAScrewByAThirdOfATurnLessPlayAndTwist) {
  const PressResult r = press(
      kCompliance + std::string("effect { tool_compliance { twist_n_m_rad: 20 } } ") + kSocket);
  EXPECT_NEAR(r.screw, 118 * kDeg - 0.15 / 20.0, 0.2 * kDeg);
  EXPECT_GT(r.peak, 20.0);
}

TEST(PressCourse, NamesWhatTheArmCannotReach) {
  EXPECT_EQ(press_course(scene_of("effect { plane { at_mm: [0, 0, -2000] normal: [0, 0, 1] } }"))
                .message(),
            "the arm cannot reach plane: (350.0, 0.0, -1990.0) mm");
}

TEST(PressCourse, ASceneWithoutAListRunsWhatTheRigDoesByItself) {
  const Simulate list = simulated_by(Scene());
  EXPECT_NE(list.find<ServoLagSpec>(), nullptr);
  EXPECT_NE(list.find<SensorNoiseSpec>(), nullptr);
  const auto course = press_course(Scene());
  ASSERT_TRUE(course) << course.message();
  const PressResult r = run_press(Scene(), *course);
  EXPECT_EQ(r.peak, 0.0);
  EXPECT_NEAR(r.sensor_off, 0.05 * std::sqrt(3.0), 0.005);
}

TEST(PressCourse, ATickDoesNotAllocate) {
  const Scene scene = scene_of(kCompliance + std::string(kFloor));
  const auto course = press_course(scene);
  ASSERT_TRUE(course);
  PressRun run(scene, *course);
  test::NoAllocation guard("PressRun::tick");
  while (run.rounds() == 0) run.tick();
  EXPECT_GT(run.rig().controller().counters().cycles, 100u);
}

}  // namespace
}  // namespace handrail
