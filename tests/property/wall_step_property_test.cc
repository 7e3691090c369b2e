// Any hand in any stage among walls with every effect.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/base/random.h"
#include "tests/unit/haptic/wall_rig.h"

namespace handrail {
namespace {

// 10^5 motions of up to 5 m/s, with stages, stalls, senseless readings and uneven ticks between.
TEST(WallStepProperty, AnyMotionGivesAFiniteForceWithinTheLimits) {
  test::WallRig rig(test::every_effect());
  rig.walls->regions[1].damping = 200.0;
  rig.walls->stages[1].pose = {Vec2(0.01, -0.02), 2.0};
  rig.walls->stages[2].gone = {1};
  Random random(11);
  Vec2 p(-0.02, 0.01), v(0.0, 0.0);
  Vec3 last = Vec3::Zero();
  bool last_ok = false;
  for (int motion = 0; motion < 100'000; ++motion) {
    v = 5.0 * random.uniform() * Vec2(random.normal(), random.normal()).normalized();
    for (int i = 0; i < 5; ++i) {
      const double dt = 1e-4 + 2e-3 * random.uniform();
      const Vec2 way = v * dt;
      p += way;
      if (p.cwiseAbs().maxCoeff() > 0.1) {
        v = -v;
        p = p.cwiseMax(-0.1).cwiseMin(0.1);
      }
      if (random.uniform() < 1e-3) rig.in.stage = static_cast<int>(random.bits() % 5) - 1;
      const bool senseless = random.uniform() < 1e-3;
      rig.in.hand.valid = random.uniform() > 1e-3;
      rig.in.hand.X_MH.p = Vec3(p.x(), p.y(), 0.0);
      rig.in.hand.v_MH = Vec3(v.x(), v.y(), 0.0);
      if (senseless) rig.in.hand.X_MH.p[static_cast<int>(random.bits() % 2)] = std::nan("");
      wall_step(rig.settings, rig.in, dt, rig.state, rig.out);
      const Vec3& f = rig.out.f_H_M.force;
      ASSERT_TRUE(is_finite(f)) << motion;
      ASSERT_LE(f.norm(), rig.settings.force.peak * (1.0 + 1e-12)) << motion;
      ASSERT_EQ(f.z(), 0.0);
      const bool ok = rig.in.hand.valid && !senseless;
      if (!ok) {
        ASSERT_EQ(f, Vec3::Zero());
      }
      last_ok = ok;
      last = f;
    }
  }
  EXPECT_TRUE(last_ok || last.isZero());
}

// However walls, regions and locks come and go around it, a hand at rest feels no more than the
// step limit from tick to tick.
TEST(WallStepProperty, AHandAtRestFeelsBoundedStepsThroughAllStages) {
  Random random(12);
  for (int scene = 0; scene < 200; ++scene) {
    test::WallRig rig(test::every_effect());
    for (WallStage& stage : rig.walls->stages) {
      stage.pose = {0.02 * Vec2(random.normal(), random.normal()), 3.0 * random.normal()};
      if (random.uniform() < 0.5) stage.gone = {1};
    }
    const Vec2 at = 0.02 * Vec2(random.normal(), random.normal());
    Vec2 last = rig.move(at);
    for (int i = 0; i < 600; ++i) {
      if (random.uniform() < 0.02) rig.in.stage = static_cast<int>(random.bits() % 3);
      const Vec2 f = rig.move(at);
      ASSERT_LE((f - last).norm(), rig.settings.force.step + 1e-9) << scene << " " << i;
      last = f;
    }
  }
}

}  // namespace
}  // namespace handrail
