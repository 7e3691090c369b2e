#include "server/follow/contact_monitor.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

constexpr double kCycle = 0.0071;  // [s]

// Cycles until the monitor speaks, at most 100.
struct Spoken {
  int cycles = 0;
  Reason why = Reason::kNone;
};
template <class Cycle>
Spoken watch(const BumperSettings& settings, const Cycle& cycle) {
  ContactMonitor monitor;
  Vec3 f, moved, rest;
  for (int i = 1; i <= 100; ++i) {
    f = moved = rest = Vec3::Zero();
    cycle(i, f, moved, rest);
    const Reason why = monitor.judge(settings, f, moved, rest, kCycle);
    if (why != Reason::kNone) return {i, why};
  }
  return {100, Reason::kNone};
}

TEST(ContactMonitor, AForceThatGrowsTheWayTheTipGoesHasTheWrongSign) {
  const Spoken spoken = watch({}, [](int i, Vec3& f, Vec3& moved, Vec3&) {
    f.x() = 11.0 + i;
    moved.x() = 1e-4;
  });
  EXPECT_EQ(spoken.why, Reason::kSensorSign);
  EXPECT_EQ(spoken.cycles, 10);  // eight and the sensor's lag
}

TEST(ContactMonitor, AnotherSurfaceMetOnTheWayIsNoWrongSign) {
  // Leaning against a wall in -Y and let go toward it, the tip meets a floor.
  const Spoken spoken = watch({}, [](int i, Vec3& f, Vec3& moved, Vec3&) {
    f = Vec3(0.0, -30.0 + 0.2 * i, std::min(60.0, 15.0 + 4.0 * i));
    moved = Vec3(0.0, -1e-4, -0.1e-4);
  });
  EXPECT_EQ(spoken.why, Reason::kNone);
}

TEST(ContactMonitor, AForceThatJumpsAsNoWayExplainsIsAnotherContactAndNoWrongSign) {
  const Spoken spoken = watch({}, [](int i, Vec3& f, Vec3& moved, Vec3&) {
    f = Vec3(12.0, 0.0, 0.0);
    if (i > 40) f = Vec3(30.0 - 0.05 * i, 0.0, 0.0);  // and is let go from there on
    moved.x() = 1e-5;
  });
  EXPECT_EQ(spoken.why, Reason::kNone);
}

TEST(ContactMonitor, ARetreatASlideAndAStandAreNoWrongSign) {
  for (const Vec3& way : {Vec3(1e-4, 0, 0), Vec3(-2e-5, 1e-4, 0), Vec3(1e-6, 0, 0)}) {
    const bool out = way.x() == 1e-4;
    const Spoken spoken = watch({}, [&](int i, Vec3& f, Vec3& moved, Vec3&) {
      f.x() = out ? std::max(0.0, 45.0 - i) : std::min(45.0, 11.0 + i);
      moved = way;
    });
    EXPECT_EQ(spoken.why, Reason::kNone) << way.transpose();
  }
}

TEST(ContactMonitor, WhatTheSensorsLagOrItsNoiseExplainsIsNoWrongSign) {
  BumperSettings late;
  late.sensor_lag = 0.05;
  // The hand has turned round, the force still grows for as long as it is late.
  EXPECT_EQ(watch(late,
                  [](int i, Vec3& f, Vec3& moved, Vec3&) {
                    f.x() = i <= 8 ? 20.0 + 5.0 * i : std::max(0.0, 60.0 - 2.0 * (i - 8));
                    moved.x() = 1e-4;
                  })
                .why,
            Reason::kNone);
  BumperSettings noisy;
  noisy.noise = 2.0;
  EXPECT_EQ(watch(noisy,
                  [](int i, Vec3& f, Vec3& moved, Vec3&) {
                    f.x() = 25.0 + i % 12;
                    moved.x() = 1e-4;
                  })
                .why,
            Reason::kNone);
}

TEST(ContactMonitor, WithoutAContactAWanderingZeroIsNoWrongSign) {
  EXPECT_EQ(watch({},
                  [](int i, Vec3& f, Vec3& moved, Vec3&) {
                    f.x() = 0.099 * i;
                    moved.x() = 1e-4;
                  })
                .why,
            Reason::kNone);
}

TEST(ContactMonitor, AForceThatStaysIsUnrelievedAfter200MsUnlessThePushGoesOn) {
  const auto stays = [](int, Vec3& f, Vec3&, Vec3&) { f.x() = 90.0; };
  const Spoken spoken = watch({}, stays);
  EXPECT_EQ(spoken.why, Reason::kContactUnrelieved);
  EXPECT_EQ(spoken.cycles, 29);
  EXPECT_EQ(watch({},
                  [](int i, Vec3& f, Vec3&, Vec3& rest) {
                    f.x() = 90.0;
                    rest.x() = -1e-4 * i;
                  })
                .why,
            Reason::kNone);
  EXPECT_EQ(watch({}, [](int, Vec3& f, Vec3&, Vec3&) { f.x() = 79.0; }).why, Reason::kNone);
  EXPECT_EQ(watch({}, [](int i, Vec3& f, Vec3&, Vec3&) { f.x() = 400.0 - 2.0 * i; }).why,
            Reason::kNone);
}

}  // namespace
}  // namespace handrail
