#include "server/task/screw_measure.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(ScrewMeasure, MeanForceIsOverSamplesAboveTwoNewtons) {
  ScrewMeasure measure;
  measure.add(1.0, Vec3::Zero(), 0.0);
  measure.add(1.0, Vec3::Zero(), 10.0);
  measure.add(1.0, Vec3::Zero(), 2.0);  // touching means more
  measure.add(3.0, Vec3::Zero(), 30.0);
  measure.add(1.0, Vec3::Zero(), 1.9);
  const ScrewMeasured out = measure.measured();
  EXPECT_DOUBLE_EQ(out.mean_force, 25.0) << "10 N for a second and 30 N for three";
  EXPECT_DOUBLE_EQ(out.contact_time, 4.0);
  EXPECT_DOUBLE_EQ(out.impulse, 100.0);
  EXPECT_DOUBLE_EQ(out.max_force, 30.0);
}

TEST(ScrewMeasure, WithoutContactThereIsNoMeanButALargestForce) {
  ScrewMeasure measure;
  measure.add(1.0, Vec3::Zero(), 1.5);
  const ScrewMeasured out = measure.measured();
  EXPECT_EQ(out.mean_force, 0.0);
  EXPECT_EQ(out.contact_time, 0.0);
  EXPECT_EQ(out.impulse, 0.0);
  EXPECT_DOUBLE_EQ(out.max_force, 1.5);
}

TEST(ScrewMeasure, ThePathIsByVerticesHalfAMillimetreApart) {
  ScrewMeasure measure;
  for (int i = 0; i <= 1000; ++i) {
    // Ten millimetres down, trembling by a tenth of one across.
    measure.add(1e-3, Vec3(1e-4 * (i % 2), 0.0, -1e-5 * i), 0.0);
  }
  EXPECT_NEAR(measure.measured().path, 10e-3, 0.3e-3) << "tremor is no way made";
}

}  // namespace
}  // namespace handrail
