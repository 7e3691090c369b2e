// The closed-form contact against its own equation and against plain integration.
#include "server/lab/accuracy/contact_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

// Under, over and critically damped: the rates of x and v are what the equation says.
TEST(SpringMotion, SolvesItsEquationHoweverDamped) {
  for (const double damping : {0.0, 3.0, 2.0 * std::sqrt(0.5 * 200.0), 80.0}) {
    const Motion1 from{0.01, -0.2};
    const auto at = [&](double t) { return spring_motion(0.5, damping, 200.0, 0.003, from, t); };
    EXPECT_NEAR(at(0.0).x, from.x, 1e-15);
    EXPECT_NEAR(at(0.0).v, from.v, 1e-15);
    for (const double t : {0.01, 0.1, 0.3}) {
      constexpr double h = 1e-6;
      const Motion1 before = at(t - h), now = at(t), after = at(t + h);
      EXPECT_NEAR((after.x - before.x) / (2.0 * h), now.v, 1e-7) << damping;
      const double force = -damping * now.v - 200.0 * (now.x - 0.003);
      EXPECT_NEAR((after.v - before.v) / (2.0 * h), force / 0.5, 1e-5) << damping;
    }
  }
}

TEST(ExactContact, MeetsAndLeavesTheWallAsFineStepsDo) {
  ContactModel model;
  model.mass = 0.2;
  model.damping = 0.5;
  model.rest = -0.001;
  model.wall = 20e3;
  Motion1 s{-0.01, 0.3};
  const ExactContact exact(model, s, 0.5);
  constexpr double h = 1e-7;
  int crossings = 0;
  for (int i = 1; i <= 5'000'000; ++i) {
    const double x = s.x;
    const double half = s.v + 0.5 * h * model.force(s.x, s.v) / model.mass;
    s.x += h * half;
    s.v = half + 0.5 * h * model.force(s.x, half) / model.mass;
    crossings += (x > 0.0) != (s.x > 0.0);
    if (i % 100'000 != 0) continue;
    ASSERT_NEAR(exact.at(i * h).x, s.x, 1e-8) << i * h;
    ASSERT_NEAR(exact.at(i * h).v, s.v, 1e-5) << i * h;
  }
  EXPECT_GE(crossings, 4);  // it bounced
}

TEST(ExactContact, RestsWherePushAndWallBalance) {
  ContactModel model;
  model.rest = 0.01;
  const ExactContact exact(model, {-0.001, 0.0}, 5.0);
  EXPECT_NEAR(exact.at(5.0).x, model.stiffness * model.rest / (model.stiffness + model.wall), 1e-9);
}

}  // namespace
}  // namespace handrail
