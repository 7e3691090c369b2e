// The two scenes of screw fastening differ in the protection alone.
#include <gtest/gtest.h>

#include "server/lab/study/screw/screw_trial.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

TEST(ScrewScenes, WithoutProtectionIsAsTheStudyHasIt) {
  const SceneLibrary library;
  const auto file = [&](const char* name) { return *library.find(name); };
  pb::Scene with, without;
  const auto c = load_scene_file(file("screw-fastening"), &with);
  const auto nc = load_scene_file(file("screw-fastening-nc"), &without);
  ASSERT_TRUE(c) << c.message();
  ASSERT_TRUE(nc) << nc.message();
  Scene left = *c;
  set_protection(false, left);
  EXPECT_EQ(nc->bumper.enabled, left.bumper.enabled);
  EXPECT_EQ(nc->guidance.spring, left.guidance.spring);
  EXPECT_TRUE(c->bumper.enabled);
  EXPECT_GT(c->guidance.spring, 0.0);
  // All else is the same.
  with.mutable_bumper()->set_enabled(false);
  with.mutable_guidance()->set_spring_n_mm(0.0);
  with.set_name(without.name());
  with.set_description(without.description());
  EXPECT_EQ(with.DebugString(), without.DebugString());
}

}  // namespace
}  // namespace handrail
