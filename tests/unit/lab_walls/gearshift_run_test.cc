#include "server/lab/walls/gearshift_run.h"

#include <gmock/gmock.h>

#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;

class GearshiftRun : public ::testing::Test {
 protected:
  GearshiftRun() : scene(*SceneLibrary().load("gearshift")), gate(*GearGate::of(scene)) {}
  GearshiftResult shift(std::uint64_t seed, int person, bool traced = false) {
    WallRunOptions options;
    options.traced = traced;
    return shift_gears(scene, gate, joystick_person(seed, person), options);
  }
  Scene scene;
  GearGate gate;
};

TEST_F(GearshiftRun, EveryDriverVisitsEveryGearOnceAndReturns) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (int person = 0; person < 30; ++person) {
      EXPECT_THAT(shift(seed, person).visited, ElementsAre("N", "1", "2", "3", "4", "5", "R", "N"))
          << "seed " << seed << ", person " << person;
    }
  }
}

TEST_F(GearshiftRun, WallsGiveNoSpikeWhereAislesMeet) {
  double most = 0.0;
  for (int person = 0; person < 60; ++person) {
    const GearshiftResult r = shift(1, person);
    EXPECT_LE(r.junction_ratio, 1.3) << person;
    most = std::max(most, r.junction_ratio);
  }
  EXPECT_GT(most, 0.5) << "nobody touched a wall at a junction";
}

TEST_F(GearshiftRun, JunctionsAreWhereTheAislesOfTheGearsMeet) {
  EXPECT_THAT(gate.junctions(), ElementsAre(Vec2(-0.040, 0.0), Vec2(0.0, 0.0), Vec2(0.040, 0.0)));
  EXPECT_NEAR(gate.junction_reach(), 0.020, 1e-12);
}

TEST_F(GearshiftRun, LocksOpenInTheOrderTheyClosedAndTheSpringBringsTheLeverHome) {
  const GearshiftResult r = shift(1, 0);
  std::string locked;
  std::vector<std::string> closed;
  double last = 0.0;
  for (const GearEvent& event : r.events) {
    EXPECT_GE(event.t, last);
    last = event.t;
    if (event.kind == GearEvent::Kind::kLock) {
      EXPECT_EQ(locked, "") << "a lock closed in " << locked;
      closed.push_back(locked = event.gear);
    } else if (event.kind == GearEvent::Kind::kUnlock) {
      EXPECT_EQ(locked, event.gear);
      locked.clear();
    } else {
      EXPECT_EQ(locked, "") << "returned while in gear";
      EXPECT_EQ(event.gear, "N");
    }
  }
  EXPECT_THAT(closed, ElementsAre("1", "2", "3", "4", "5", "R"));
  ASSERT_FALSE(r.events.empty());
  EXPECT_EQ(r.events.back().kind, GearEvent::Kind::kReturn);
}

TEST_F(GearshiftRun, NobodyGoesDeeperThanEnergyAllows) {
  double most = 0.0;
  for (int person = 0; person < 30; ++person) {
    const GearshiftResult r = shift(1, person);
    EXPECT_LE(r.share_of_bound, 1.0) << person;
    most = std::max(most, r.deepest);
  }
  EXPECT_GT(most, 1e-3) << "nobody touched a wall hard";
}

// The aisles of the shipped scene by their own formula, fillets of 4 mm and all.
bool in_aisles(const Vec2& p) {
  constexpr double kSlack = 1e-9;
  const auto in_stadium = [&](double x) {
    const double past = std::max(std::abs(p.y()) - 0.045, 0.0);
    return std::hypot(p.x() - x, past) <= 0.007 + kSlack;
  };
  if (std::abs(p.x()) <= 0.047 + kSlack && std::abs(p.y()) <= 0.007 + kSlack) return true;
  for (const double x : {-0.040, 0.0, 0.040}) {
    if (in_stadium(x)) return true;
    const double across = std::abs(p.x() - x), up = std::abs(p.y());
    const bool outer = std::abs(p.x()) > 0.047;
    constexpr double r = 0.004;
    if (!outer && across < 0.007 + r && up < 0.007 + r &&
        std::hypot(across - 0.007 - r, up - 0.007 - r) >= r - kSlack) {
      return true;
    }
  }
  return false;
}

TEST_F(GearshiftRun, TheProxyNeverLeavesTheAisles) {
  std::size_t touching = 0;
  for (const int person : {0, 1, 3, 12}) {
    for (const WallTick& tick : shift(1, person, true).trace) {
      ASSERT_TRUE(in_aisles(tick.contact.proxy)) << tick.contact.proxy.transpose();
      touching += tick.contact.touching;
    }
  }
  EXPECT_GT(touching, 500u);
}

TEST_F(GearshiftRun, IsTheSameAgain) {
  const GearshiftResult a = shift(3, 2, true), b = shift(3, 2, true);
  ASSERT_EQ(a.trace.size(), b.trace.size());
  for (std::size_t i = 0; i < a.trace.size(); ++i) ASSERT_EQ(a.trace[i].hand, b.trace[i].hand);
}

TEST_F(GearshiftRun, ARecordedHandIsJudgedTheSame) {
  // From neutral to gear 3 in a second, there for a second, back in one, and rest.
  std::vector<RecordedSample> samples;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.02 * i;
    const double y = 0.047 * std::clamp(t < 2.0 ? t : 3.0 - t, 0.0, 1.0);
    samples.push_back({t, Vec3(0.0, y, 0.0)});
  }
  // The middle of a recording's box lies on neutral: as far down as up.
  samples.push_back({4.2, Vec3(0.0, -0.047, 0.0)});
  samples.push_back({4.6, Vec3(0.0, -0.047, 0.0)});
  const GearshiftResult r =
      shift_gears(scene, gate, joystick_person(1, 0), RecordedMotion(samples), WallRunOptions());
  EXPECT_THAT(r.visited, ElementsAre("N", "3", "4"));
}

TEST_F(GearshiftRun, NeutralCountsAtTheEndOnceTheLeverHasRestedThereUnlessItLeaves) {
  // To gears 4 and 3, to neutral for a second, and to `last` for another one.
  const auto visited = [&](double last) {
    std::vector<RecordedSample> samples;
    for (const double y : {0.0, -0.047, 0.047, 0.0, last}) {
      const double from = samples.empty() ? 0.0 : samples.back().t + 0.2;
      for (int i = 0; i <= 50; ++i) samples.push_back({from + 0.02 * i, Vec3(0.0, y, 0.0)});
    }
    return shift_gears(scene, gate, joystick_person(1, 0), RecordedMotion(samples),
                       WallRunOptions())
        .visited;
  };
  EXPECT_THAT(visited(0.003), ElementsAre("N", "4", "3", "N")) << "not far from where it rested";
  EXPECT_THAT(visited(0.020), ElementsAre("N", "4", "3"));
}

TEST_F(GearshiftRun, WaysFollowTheAisles) {
  const Vec2 one(-0.040, 0.047), two(-0.040, -0.047), three(0.0, 0.047), home(0.0, 0.0);
  EXPECT_THAT(gate.way(one, two), ElementsAre(one, two));
  EXPECT_THAT(gate.way(two, three), ElementsAre(two, Vec2(-0.040, 0.0), home, three));
  EXPECT_THAT(gate.way(home, one), ElementsAre(home, Vec2(-0.040, 0.0), one));
}

TEST_F(GearshiftRun, ScenesWithoutGearsAreRefused) {
  Scene lacking = scene;
  lacking.effects.clear();
  EXPECT_NE(GearGate::of(lacking).message().find("no detent and return spring"), std::string::npos);
}

}  // namespace
}  // namespace handrail
