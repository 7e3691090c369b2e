#include "server/follow/bumper.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;

const BumperSettings kSettings;

TEST(PublishedBumper, BelowTheThresholdTheCommandYieldsByAHundredthOfAMillimetreANewton) {
  const Vec3 p_SU(0.3, 0, 0.4);
  const Bumped out = bump_as_published(kSettings, p_SU, {0, 0, 40.0}, p_SU);
  EXPECT_LT((out.p_SB - (p_SU + Vec3(0, 0, 4e-4))).norm(), 1e-15);
  EXPECT_NE(out.why, Reason::kBumper);
}

TEST(PublishedBumper, APurePushReturnsThePreviousCommand) {
  // Contact from above; the user pushes 1 mm further down, whatever the force above the threshold.
  for (const double force : {50.1, 100.0, 400.0}) {
    const Vec3 p_last(0.3, 0.1, 0.4);
    const Vec3 p_SU = p_last - Vec3(0, 0, 1e-3 + kSettings.alpha * force);
    const Bumped out = bump_as_published(kSettings, p_SU, {0, 0, force}, p_last);
    EXPECT_LT((out.p_SB - p_last).norm(), 1e-15);
    EXPECT_EQ(out.why, Reason::kBumper);
  }
}

TEST(PublishedBumper, MovingAwayFromTheContactIsAlwaysFree) {
  Dice dice(51);
  for (int i = 0; i < 500; ++i) {
    const Vec3 f = dice.between(51.0, 500.0) * dice.unit();
    const Vec3 p_last = dice.within(0.5);
    Vec3 away = dice.within(0.01);
    if (away.dot(f) < 0.0) away = -away;
    const Bumped out = bump_as_published(kSettings, p_last + away, f, p_last);
    EXPECT_LT((out.p_SB - (p_last + away + kSettings.alpha * f)).norm(), 1e-15);
    EXPECT_NE(out.why, Reason::kBumper);
  }
}

TEST(PublishedBumper, ASlantingPushSlidesAndBacksOffByTheLengthThatIsNotNormal) {
  Dice dice(52);
  for (int i = 0; i < 500; ++i) {
    const double force = dice.between(51.0, 500.0);
    const Vec3 n = dice.unit(), p_last = dice.within(0.5);
    const Vec3 along = dice.between(0.0, 2e-3) * n.unitOrthogonal();
    const double into = dice.between(1e-6, 2e-3);
    // d, the step after (3.10), is `along - into n`.
    const Vec3 p_SU = p_last + along - (into + kSettings.alpha * force) * n;
    const double d = std::sqrt(along.squaredNorm() + into * into);
    const Vec3 expected = p_last + along + (d - into) * n;
    EXPECT_LT((bump_as_published(kSettings, p_SU, force * n, p_last).p_SB - expected).norm(),
              1e-14);
  }
}

TEST(PublishedBumper, NoForceAndNoiseInTheDeadBandLeaveTheCommandAlone) {
  Dice dice(53);
  const Vec3 p_SU = dice.within(0.5);
  EXPECT_EQ(bump_as_published(kSettings, p_SU, Vec3::Zero(), p_SU).p_SB, p_SU);
  for (int i = 0; i < 100; ++i) {
    const Vec3 noise = dice.between(0.0, 1.999) * dice.unit();
    EXPECT_EQ(bump_as_published(kSettings, p_SU, noise, dice.within(0.5)).p_SB, p_SU);
  }
  EXPECT_NE(bump_as_published(kSettings, p_SU, {2.1, 0, 0}, p_SU).p_SB, p_SU);
}

TEST(PublishedBumper, TheThresholdItselfStillYieldsInsteadOfHolding) {
  const Vec3 p_last = Vec3::Zero(), p_SU(0, 0, -1e-2);
  EXPECT_EQ(bump_as_published(kSettings, p_SU, {0, 0, 50.0}, p_last).why, Reason::kNone);
  EXPECT_EQ(bump_as_published(kSettings, p_SU, {0, 0, 50.001}, p_last).why, Reason::kBumper);
}

TEST(PublishedBumper, SwitchedOffItPassesTheCommand) {
  BumperSettings off;
  off.enabled = false;
  const Vec3 p_SU(0.1, 0.2, 0.3);
  BumperState state;
  for (const auto form : {BumperSettings::Form::kDefault, BumperSettings::Form::kPublished}) {
    off.form = form;
    EXPECT_EQ(bump(off, {p_SU, {0, 0, 400}}, state).p_SB, p_SU);
  }
}

// The law is p(n) = p_u - alpha k p(n - d) in contact of stiffness k: it settles for every delay
// if and only if alpha k < 1, 100 N/mm.
TEST(PublishedBumper, SettlesInContactSofterThan100NewtonsAMillimetreAndNotInStiffer) {
  const auto settles = [](double stiffness, int delay) {
    BumperSettings settings;
    settings.dead_band = 0.0;
    settings.threshold = 1e9;
    std::vector<double> p(static_cast<std::size_t>(delay), 0.0);
    for (int n = 0; n < 4000; ++n) {
      const Vec3 f(0, 0, -stiffness * p[p.size() - static_cast<std::size_t>(delay)]);
      p.push_back(bump_as_published(settings, {0, 0, -1e-4}, f, Vec3::Zero()).p_SB.z());
    }
    return std::abs(p.back() - p[p.size() - 1 - static_cast<std::size_t>(delay)]) < 1e-9;
  };
  for (const int delay : {1, 2, 7}) {
    EXPECT_TRUE(settles(95e3, delay)) << delay;
    EXPECT_FALSE(settles(105e3, delay)) << delay;
  }
}

}  // namespace
}  // namespace handrail
