// Things to touch are passive and bounded, whatever they are made of and however the tip moves.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "devices/rig/world/box.h"
#include "devices/rig/world/cylinder.h"
#include "devices/rig/world/plane.h"
#include "devices/rig/world/world.h"
#include "tests/property/draws.h"
#include "tests/unit/rig/probe.h"

namespace handrail {
namespace {

using test::below;
using test::between;
using test::within;

using test::Probe;

SurfaceSpec any_surface() {
  const double damping = below(2) == 0 ? 0.0 : std::pow(10.0, between(0, 6));
  return {std::pow(10.0, between(3, 9)), damping, between(0, 1)};
}

// An arm of 20 to 200 N/mm with a tool as soft as 8 N/mm sideways, tilted anyhow.
Mat3 any_compliance() {
  const Vec3 z = rotation_exp(within(2.0)) * Vec3::UnitZ();
  const double lateral = 1.0 / between(8e3, 100e3), axial = 1.0 / between(8e3, 100e3);
  return (1.0 / between(20e3, 200e3) + lateral) * Mat3::Identity() +
         (axial - lateral) * z * z.transpose();
}

// From `start` through some places near the origin, at 5 to 500 mm/s, and back.
template <typename Surface>
void go_round(Probe<Surface>& probe, const Vec3& start) {
  const double step = std::pow(10.0, between(-5.3, -3.3));
  const int places = 1 + below(5);
  for (int i = 0; i < places; ++i) probe.along(start + within(4e-3), step);
  probe.along(start, step);
  probe.along(start + Vec3(0, 0, 0.1), 0.01);
}

RC_GTEST_PROP(World, APlaneGivesBackNoMoreThanItTook, ()) {
  const Plane plane({Vec3::Zero(), Vec3::UnitZ(), any_surface()});
  const Vec3 start(0, 0, 1e-3);
  Probe probe(plane, start);
  probe.set_compliance(any_compliance());
  go_round(probe, start);
  RC_LOG() << probe.work();
  RC_ASSERT(probe.force() == Vec3::Zero());
  RC_ASSERT(probe.work() >= -1e-9);
}

// With an arm that gives way alike every way, nobody is pushed harder than the arm can.
RC_GTEST_PROP(World, ThePushIsNoHarderThanTheArmAndNeverAPull, ()) {
  const double arm = between(5e3, 500e3);
  const Vec3 n = rotation_exp(within(2.0)) * Vec3::UnitZ();
  const SurfaceSpec surface = any_surface();
  const Plane plane({Vec3::Zero(), n, surface});
  Vec3 x0 = 1e-3 * n;
  Probe probe(plane, x0, 1.0 / arm);
  const double step = std::pow(10.0, between(-5.0, -2.0));
  for (int i = 0; i < 50; ++i) {
    x0 += within(step);
    const Vec3 f = probe.to(x0, std::pow(10.0, between(-4.0, 0.0)));
    const double push = f.dot(n);
    RC_ASSERT(push >= 0.0);
    RC_ASSERT(push <= arm * std::max(0.0, -x0.dot(n)) * (1 + 1e-9));
    RC_ASSERT((f - push * n).norm() <= surface.friction * push * (1 + 1e-9) + 1e-12);
    RC_ASSERT(probe.x().isApprox(x0 + f / arm, 1e-9));
  }
}

using Thing = std::variant<Plane, Box, Cylinder>;
Thing any_thing() {
  switch (below(3)) {
    case 0: return Plane({within(2e-3), rotation_exp(within(2.0)) * Vec3::UnitZ(), any_surface()});
    case 1:
      return Box({{within(2e-3), rotation_exp(within(2.0))},
                  Vec3::Constant(1e-4) + within(9e-5),
                  any_surface()});
    default:
      return Cylinder({within(2e-3), rotation_exp(within(2.0)) * Vec3::UnitZ(), between(1e-4, 3e-3),
                       between(1e-3, 5e-3), below(2) == 1, any_surface()});
  }
}
// Several at once.
struct Heap {
  std::vector<Thing> things;
  void find(const TipStep& tip, ContactList& out) {
    for (Thing& thing : things) std::visit([&](auto& t) { t.find(tip, out); }, thing);
  }
};

RC_GTEST_PROP(World, AnyHeapOfThingsIsFinite, ()) {
  Heap heap;
  const int count = 1 + below(8);
  for (int i = 0; i < count; ++i) heap.things.push_back(any_thing());
  Vec3 x0 = within(5e-3);
  Probe probe(heap, x0);
  for (int i = 0; i < 30; ++i) {
    x0 = below(4) == 0 ? within(5e-3) : Vec3(x0 + within(5e-4));
    RC_ASSERT(is_finite(probe.to(x0)));
    RC_ASSERT(is_finite(probe.x()));
  }
}

RC_GTEST_PROP(World, TheTipComesToRestAtAnySingleThing, ()) {
  Heap one;
  one.things.push_back(any_thing());
  Vec3 x0 = within(5e-3);
  Probe probe(one, x0);
  for (int i = 0; i < 30; ++i) {
    x0 = below(4) == 0 ? within(5e-3) : Vec3(x0 + within(5e-4));
    probe.to(x0);
  }
  // A damper of 1e6 N s/m on 1e3 N/m takes 1000 s; long steps are as good as many.
  for (int i = 0; i < 500; ++i) probe.to(x0, 10.0);
  const Vec3 f = probe.force();
  probe.to(x0, 10.0);
  RC_ASSERT((probe.force() - f).norm() <= 1e-3 + 1e-6 * f.norm());
}

// Led anyhow over and into any socket, tilted and turned, the tip stays finite and comes to rest
// when it is held still.
RC_GTEST_PROP(World, AKeyInAnySocketIsFiniteAndComesToRest, ()) {
  HexSocketSpec socket;
  socket.X_SK = {within(1e-3), rotation_exp(within(0.3))};
  socket.key = between(2e-3, 10e-3);
  socket.across_flats = socket.key + between(0.01e-3, 0.3e-3);
  socket.chamfer = between(0.0, 1e-3);
  socket.guide = between(0.0, 1e-3);
  socket.depth = socket.chamfer + socket.guide + between(0.5e-3, 5e-3);
  socket.backlash = between(0.0, 0.2);
  socket.jam = between(0.0, 0.3);
  socket.surface = any_surface();
  socket.surface.stiffness = std::pow(10.0, between(5, 9));
  const ToolComplianceSpec tool{between(8e3, 100e3), between(4e3, 20e3), between(1.0, 100.0)};
  World world({{socket, ScrewThreadSpec(), ArmComplianceSpec{between(20e3, 200e3)}, tool}},
              ArmGeometry(), JointVector::Zero());
  Pose X{Vec3(0, 0, 8e-3), Quat(0, 1, 0, 0)};
  Vec3 turned = Vec3::Zero();
  const double aside = std::pow(10.0, between(-4.5, -2.5));
  for (int i = 0; i < 200; ++i) {
    X.p = i % 50 < 25 ? Vec3(0, 0, between(-6e-3, 2e-3)) : Vec3(X.p + within(5e-4));
    X.p += within(aside);
    turned += within(0.02);
    X.q = rotation_exp(turned) * Quat(0, 1, 0, 0);
    world.lead(X, 1e-3);
    RC_ASSERT(is_finite(world.tip()));
    RC_ASSERT(is_finite(world.on_tip()));
    RC_ASSERT(std::isfinite(world.screw_angle()));
  }
  X.p = Vec3(0, 0, between(-6e-3, 2e-3)) + within(1.5e-3);
  for (int i = 0; i < 500; ++i) world.lead(X, 10.0);
  const Vec3 f = world.on_tip().force;
  world.lead(X, 10.0);
  RC_ASSERT((world.on_tip().force - f).norm() <= 0.5 + 1e-3 * f.norm());
}

}  // namespace
}  // namespace handrail
