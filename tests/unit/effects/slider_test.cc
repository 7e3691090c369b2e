#include "server/effects/slider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace handrail {
namespace {

constexpr double kT = 1e-3;
constexpr double kCount = 0.0942e-3;  // of the joystick's encoders [m]
constexpr double kInf = std::numeric_limits<double>::infinity();

SliderLaw law_of(double viscosity, double yield = 1e9, double coupling = 2500.0) {
  return {coupling, viscosity, yield};
}

// A free mass under a law, force held over each period, exact in between.
struct SlidMass {
  double m = 0.3, x = 0.0, v = 0.0;
  void step(double f) {
    x += v * kT + 0.5 * f / m * kT * kT;
    v += f / m * kT;
  }
};

TEST(Slider, DragsWithViscosityTimesSpeedAtASteadySpeedWhateverTheViscosity) {
  for (const double b : {0.5, 2.0, 20.0, 188.0, 6283.0}) {
    Slider slider;
    slider.restart(Vec2::Zero());
    Vec2 f = Vec2::Zero();
    const Vec2 v(0.03, -0.04);
    const int ticks = 100 + static_cast<int>(30.0 * b / 2500.0 / kT);
    for (int i = 1; i <= ticks; ++i) f = slider.force(i * kT * v, law_of(b), kT);
    EXPECT_NEAR(f.x(), -b * v.x(), 1e-6 * b) << b;
    EXPECT_NEAR(f.y(), -b * v.y(), 1e-6 * b) << b;
  }
}

TEST(Slider, StartingFromRestFollowsTheMaxwellElement) {
  const double k = 2500.0, b = 188.0, speed = 0.05;
  Slider slider;
  slider.restart(Vec2::Zero());
  // Small ticks: f = -B v (1 - exp(-k t / B)).
  const double dt = 1e-5;
  for (int i = 1; i <= 20000; ++i) {
    const double f = slider.force({i * dt * speed, 0.0}, law_of(b), dt).x();
    if (i % 1000 != 0) continue;
    const double expected = -b * speed * (1.0 - std::exp(-k * i * dt / b));
    EXPECT_NEAR(f, expected, 2e-3 * b * speed) << i;
  }
}

// The printed law held for a period doubles a mass's speed back and forth beyond B T / m = 2.
TEST(Slider, AMassComesToRestWhereThePrintedLawDiverges) {
  for (const double ratio : {0.5, 2.0, 2.5, 10.0, 1e3, 1e6}) {
    SlidMass printed, ours;
    printed.v = ours.v = 0.5;
    const double b = ratio * ours.m / kT;
    Slider slider;
    slider.restart(Vec2::Zero());
    double late = 0.0, widest = 0.0;
    for (int i = 0; i < 60'000; ++i) {
      if (i < 300) printed.step(-b * printed.v);
      ours.step(slider.force({ours.x, 0.0}, law_of(b, 25.0), kT).x());
      widest = std::max(widest, std::abs(ours.v));
      if (i > 50'000) late = std::max(late, std::abs(ours.v));
    }
    if (ratio > 2.0) {
      EXPECT_FALSE(std::abs(printed.v) < 1e3) << ratio;
    }
    EXPECT_LE(widest, 0.5 * (1.0 + 1e-9)) << ratio;
    EXPECT_LT(late, 1e-6) << ratio;
  }
}

TEST(Slider, CountsOfTheEncoderDoNotMakeItBuzz) {
  for (const double b : {2.0, 188.0, 6283.0, kInf}) {
    SlidMass mass;
    mass.v = 0.2;
    Slider slider;
    slider.restart(Vec2::Zero());
    double late = 0.0;
    for (int i = 0; i < 60'000; ++i) {
      const double read = kCount * std::round(mass.x / kCount);
      // The device's own Coulomb friction, as little as 0.05 N.
      const double f = slider.force({read, 0.0}, law_of(b, 25.0), kT).x();
      const double lost = 0.05 / mass.m * kT;
      mass.step(f);
      mass.v = std::abs(mass.v) < lost ? 0.0 : mass.v - std::copysign(lost, mass.v);
      if (i > 50'000) late = std::max(late, std::abs(mass.v));
    }
    EXPECT_LT(late, 2e-3) << b;
  }
}

TEST(Slider, ACountChangesTheForceByAtMostSevenQuartersOfTheCouplingTimesIt) {
  for (const double b : {0.5, 5.0, 188.0, 6283.0, kInf}) {
    Slider slider;
    slider.restart(Vec2::Zero());
    double last = 0.0;
    for (int i = 1; i < 2000; ++i) {
      const int counts = i / 3;  // one more every third step
      const double f = slider.force({kCount * counts, 0.0}, law_of(b), kT).x();
      EXPECT_LE(std::abs(f - last), 1.75 * 2500.0 * kCount * (1.0 + 1e-9)) << b << " at " << i;
      last = f;
    }
  }
}

TEST(Slider, YieldsAtItsForceAndThenDragsWithIt) {
  Slider slider;
  slider.restart(Vec2::Zero());
  const SliderLaw law = law_of(kInf, 2.0);
  // Elastic first: under 2 N / 2.5 N/mm it comes back to zero force.
  EXPECT_NEAR(slider.force({0.4e-3, 0.0}, law, kT).x(), -1.75, 1e-9);  // with the small damper
  EXPECT_NEAR(slider.force({0.4e-3, 0.0}, law, kT).x(), -1.0, 1e-9);
  slider.force({0.0, 0.0}, law, kT);
  EXPECT_NEAR(slider.force({0.0, 0.0}, law, kT).x(), 0.0, 1e-12);
  double f = 0.0;
  for (int i = 1; i <= 1000; ++i) f = slider.force({i * 1e-5, 0.0}, law, kT).x();
  EXPECT_NEAR(f, -2.0, 1e-9);
  // Held still it keeps pulling back from where it gave way, within the yield, and does not creep.
  for (int i = 0; i < 100'000; ++i) f = slider.force({1e-2, 0.0}, law, kT).x();
  EXPECT_NEAR(f, -2.0, 1e-6);
}

TEST(Slider, NeverGivesBackMoreThanItTookAroundALoop) {
  for (const double b : {5.0, 188.0, kInf}) {
    Slider slider;
    slider.restart({0.03, 0.0});
    Vec2 last(0.03, 0.0);
    double energy = 0.0;
    for (int i = 1; i <= 20'000; ++i) {
      const double a = 2.0 * 3.14159265358979 * i / 2000.0;
      const Vec2 x(0.03 * std::cos(a), 0.01 * std::sin(3.0 * a));
      // The force of the tick acts on the way to the next reading; a fine path makes it the same.
      energy += slider.force(x, law_of(b, 5.0), kT).dot(x - last);
      last = x;
      ASSERT_LT(energy, 1e-9) << b << " at " << i;
    }
    EXPECT_LT(energy, -0.01);
  }
}

}  // namespace
}  // namespace handrail
