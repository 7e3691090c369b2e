// The judge of accepted targets against streams made by hand: sound ones pass, each limit is named.
#include "server/lab/faults/audit/controller_audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/model/rv2a_limits.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr Nanos kPeriod = 7'100 * kMicrosecond;
const double kT = to_seconds(kPeriod);
// What J1 may change by in one cycle [rad].
const double kStep = rv2a_limits().max_speed[0] * kT;
const double kChange = rv2a_limits().max_acceleration[0] * kT * kT;
const double kJolt = rv2a_limits().max_jerk[0] * kT * kT * kT;

// J1 is led by a client, a controller takes it over the wire.
class Client {
 public:
  explicit Client(double q1 = 0.0) : audit(rv2a_limits(), kPeriod) {
    q << q1, 0.0, 1.5, 0.0, 1.5, 0.0;
    audit.place(q);
  }

  // A cycle without a target.
  void miss(int cycles = 1) { now += cycles * kPeriod; }
  TargetVerdict step(double by) {
    now += kPeriod;
    q[0] += by;
    const JointVector wire = q.cast<float>().cast<double>();
    return audit.accepted(now, wire, std::exchange(unheard, 0));
  }
  // Changes J1's speed to `speed` [rad a cycle] as fast as `share` of its limits lets it; cycles
  // for which `lost` holds do not reach the controller.
  template <typename Lost>
  void change_speed(double speed, double share, Lost lost) {
    const double jolt = share * kJolt, hard = share * kChange;
    const double way = speed - v;
    const int n = static_cast<int>(
        std::ceil(std::max(std::sqrt(std::abs(way) / jolt), std::abs(way) / hard)));
    const double rise = way / (n * n);
    double change = 0.0;
    for (int i = 0; i < 2 * n; ++i) {
      change += i < n ? rise : -rise;
      v = i == 2 * n - 1 ? speed : v + change;
      go(lost(cycle++));
    }
  }
  void change_speed(double speed, double share = 0.99) {
    change_speed(speed, share, [](int) { return false; });
  }
  void coast(int cycles) {
    for (int i = 0; i < cycles; ++i) go(false);
  }
  void go(bool lost) {
    if (lost) {
      miss();
      ++unheard;
      q[0] += v;
    } else {
      (void)step(v);
    }
  }

  ControllerAudit audit;
  JointVector q;
  Nanos now = 0;
  double v = 0.0;
  int cycle = 0;
  int unheard = 0;  // targets sent since the last that came
};

TEST(ControllerAudit, ASoundMotionHasNoBreach) {
  Client c(-3.0);  // where float32 is coarse
  c.change_speed(0.9 * kStep);
  c.coast(20);
  c.change_speed(-0.9 * kStep);
  c.change_speed(0.0);
  c.coast(5);
  EXPECT_EQ(c.audit.breaches(), 0u) << c.audit.worst().worst();
  EXPECT_EQ(c.audit.halts(), 0u);
  EXPECT_EQ(c.audit.held(), 0u);
  EXPECT_GT(c.audit.targets(), 100u);
  EXPECT_GT(c.audit.worst().jerk, 0.1);
  EXPECT_GT(c.audit.worst().acceleration, 0.9);
  EXPECT_NEAR(c.audit.worst().speed, 0.9, 1e-3);
}

TEST(ControllerAudit, SeesEachLimitBroken) {
  Client fast;
  fast.change_speed(0.99 * kStep);
  EXPECT_EQ(fast.audit.breaches(), 0u);
  const TargetVerdict speed = fast.step(1.01 * kStep);
  EXPECT_FALSE(speed.fine());
  EXPECT_NEAR(speed.speed, 1.01, 1e-3);
  EXPECT_NEAR(speed.step, 1.01, 1e-3);
  EXPECT_LT(speed.acceleration, 1.0);
  EXPECT_EQ(speed.joint, 0);

  Client hard;  // faster and faster by more than the limit, the jerk being small
  double by = 0.0;
  TargetVerdict found;
  for (double change = 0.0; found.fine(); change += 0.3 * kJolt) found = hard.step(by += change);
  EXPECT_GT(found.acceleration, 1.0);
  EXPECT_LT(found.acceleration, 1.2);
  EXPECT_NEAR(found.jerk, 0.3, 0.01);
  EXPECT_LT(found.speed, 1.0);

  Client jerky;
  const TargetVerdict jerk = jerky.step(1.01 * kJolt);
  EXPECT_FALSE(jerk.fine());
  EXPECT_TRUE(jerk.from_rest);
  EXPECT_NEAR(jerk.jerk, 1.01, 1e-3);
  EXPECT_LT(jerk.acceleration, 1.0);
  EXPECT_EQ(jerky.audit.breaches(), 1u);
  EXPECT_TRUE(Client().step(0.99 * kJolt).fine());
}

// A target comes as float32: near 3 rad its rounding alone is 0.3 % of the jerk limit.
TEST(ControllerAudit, ForgivesWhatTheWireRounds) {
  for (int i = 0; i < 500; ++i) {
    Client c(-2.7 + 1e-3 * i);
    EXPECT_TRUE(c.step(0.9999 * kJolt).fine()) << i;
    EXPECT_TRUE(c.step(1.9999 * kJolt).fine()) << i;
  }
  EXPECT_FALSE(Client(-2.7).step(1.01 * kJolt).fine());
}

TEST(ControllerAudit, SeesAJumpFromWhereTheArmStands) {
  Client c;
  c.q[3] += 0.1;
  const TargetVerdict found = c.step(0.0);
  EXPECT_FALSE(found.fine());
  EXPECT_EQ(found.joint, 3);
  EXPECT_NEAR(found.step, 0.1 / (rv2a_limits().max_speed[3] * kT), 1e-3);
}

TEST(ControllerAudit, AMotionMayGoOnThroughGapsWhileItIsWithinACycleAtFullSpeed) {
  for (int every = 2; every < 12; ++every) {
    Client c;
    c.change_speed(0.45 * kStep, 0.99, [&](int k) { return k > 2 && k % every == 0; });
    c.change_speed(0.0, 0.99, [&](int k) { return k % every == 0; });
    c.coast(40);
    EXPECT_EQ(c.audit.breaches(), 0u) << every << ": " << c.audit.worst().worst();
    EXPECT_EQ(c.audit.halts(), 0u) << every;
    EXPECT_GT(c.audit.held(), 2u) << every;
  }
  Client fast;
  fast.change_speed(0.6 * kStep);
  fast.go(true);
  const TargetVerdict found = fast.step(fast.v);
  EXPECT_NEAR(found.step, 1.2, 1e-3) << "two cycles at once";
  EXPECT_FALSE(found.fine());
}

// What is told a step a reply falls behind where the controller's clock would have it.
TEST(ControllerAudit, SeesAMotionThatGoesOnAsIfAGapHadTakenNoTime) {
  Client c;
  c.change_speed(0.9 * kStep);
  c.coast(3);
  c.miss();
  (void)c.step(c.v);
  EXPECT_EQ(c.audit.breaches(), 1u);
  // Half the speed over two cycles: -0.45 kStep in the mean of one and two cycles.
  EXPECT_NEAR(c.audit.worst().acceleration, 0.45 * kStep / 1.5 / kChange, 0.02);
}

TEST(ControllerAudit, AStartFromRestAfterAGapIsFineAndTheHaltBeforeItIsListed) {
  Client c;
  c.change_speed(0.33 * kStep);
  c.miss(4);
  c.v = 0.0;
  c.change_speed(-0.2 * kStep);
  EXPECT_EQ(c.audit.breaches(), 0u);
  EXPECT_EQ(c.audit.halts(), 1u);
  EXPECT_NEAR(c.audit.hardest_halt(), 0.33 * kStep / kChange, 0.01);  // about 7
  EXPECT_EQ(c.audit.held(), 4u);
}

TEST(ControllerAudit, SeesAStartAtSpeedAfterAGapHoweverLong) {
  for (const int cycles : {2, 5, 20, 30, 100, 10'000}) {
    Client c;
    c.change_speed(0.9 * kStep);
    c.miss(cycles);
    (void)c.step(c.v);
    (void)c.step(c.v);
    EXPECT_GE(c.audit.breaches(), 1u) << cycles;
    EXPECT_GT(c.audit.worst().acceleration, cycles == 20 ? 1.5 : 3.0) << cycles;
  }
}

TEST(ControllerAudit, AMotionThatWasBrakedIsNoHalt) {
  Client c;
  c.change_speed(0.5 * kStep);
  c.change_speed(0.0);
  c.miss(1000);
  c.change_speed(0.5 * kStep);
  c.change_speed(0.0);
  c.audit.until(c.now + kSecond);
  EXPECT_EQ(c.audit.breaches(), 0u);
  EXPECT_EQ(c.audit.halts(), 0u);
  EXPECT_EQ(c.audit.held(), 0u);
}

TEST(ControllerAudit, AMotionThatBreaksOffForGoodIsAHalt) {
  Client c;
  c.change_speed(0.33 * kStep);
  c.audit.until(c.now + 10 * kPeriod);
  EXPECT_EQ(c.audit.halts(), 0u) << "it may still go on";
  c.audit.until(c.now + kSecond);
  EXPECT_EQ(c.audit.halts(), 1u);
  EXPECT_NEAR(c.audit.hardest_halt(), 0.33 * kStep / kChange, 0.01);
}

TEST(ControllerAudit, ATargetThatIsHeldAnywayOnlyProlongsTheHold) {
  Client repeated;
  repeated.change_speed(0.33 * kStep);
  EXPECT_TRUE(repeated.step(0.0).fine());
  repeated.miss();
  EXPECT_TRUE(repeated.step(0.0).fine());
  EXPECT_TRUE(repeated.step(0.9 * kJolt).fine());
  EXPECT_TRUE(repeated.step(1.8 * kJolt).fine());
  EXPECT_EQ(repeated.audit.halts(), 1u);
}

TEST(ControllerAudit, AStartMayHaveBeenPlannedWhileItsFirstTargetsWereLost) {
  for (int lost = 0; lost < 6; ++lost) {
    Client c;
    c.change_speed(0.33 * kStep);
    c.miss(10);
    c.v = 0.0;
    const int first = c.cycle;
    c.change_speed(0.3 * kStep, 0.99, [&](int k) { return k < first + lost; });
    EXPECT_EQ(c.audit.breaches(), 0u) << lost << ": " << c.audit.worst().worst();
    EXPECT_LE(c.audit.halts(), 1u) << lost;  // in a longer gap it may have braked
    // The same step with nothing lost is a jump.
    Client jump;
    double way = 0.0;
    for (int i = 1; i <= lost + 1; ++i) way += 0.9 * i * kJolt;
    EXPECT_EQ(jump.step(way).fine(), lost == 0) << lost;
  }
}

// One step after a gap can be the next of the old motion or the first of a new one.
TEST(ControllerAudit, WhenAStartWasPlannedMayOnlyShowByTheNextTarget) {
  Client client;
  // The first two are lost. The third is sound as the second of a motion; the fourth then is not.
  const double unit = 0.75 * kJolt;
  bool lost[] = {true, true, false, false, false, false};
  double speed[] = {1, 2, 2, 1, 0, 0};
  for (std::size_t i = 0; i < std::size(lost); ++i) {
    client.v = speed[i] * unit;
    client.go(lost[i]);
  }
  EXPECT_EQ(client.audit.breaches(), 0u);
  EXPECT_GT(client.audit.worst().jerk, 0.6);
}

TEST(ControllerAudit, KeepsBothReadingsOpenUntilOneFails) {
  for (const bool goes_on : {true, false}) {
    Client c;
    c.change_speed(0.3 * kJolt);
    c.miss();
    c.miss();
    EXPECT_TRUE(c.step(0.9 * kJolt).fine());
    EXPECT_EQ(c.audit.halts(), 0u);
    c.miss();
    EXPECT_TRUE(c.step(goes_on ? 0.6 * kJolt : -0.95 * kJolt).fine());
    EXPECT_EQ(c.audit.breaches(), 0u);
  }
}

TEST(ControllerAudit, ABreachIsNotForgottenByWhatFollows) {
  Client c;
  (void)c.step(0.5 * kStep);
  const std::uint64_t breaches = c.audit.breaches();
  c.v = 0.5 * kStep;
  c.coast(20);
  EXPECT_GE(breaches, 1u);
  EXPECT_LE(c.audit.breaches(), 3u) << "speed is judged as it is from then on";
  EXPECT_NEAR(c.audit.worst().acceleration, 0.5 * kStep / kChange, 0.02);
}

TEST(ControllerAudit, DoesNotAllocate) {
  Client c;
  const test::NoAllocation guard("ControllerAudit");
  c.change_speed(0.5 * kStep);
  c.miss(3);
  c.change_speed(0.0);
  c.audit.until(c.now + kSecond);
}

}  // namespace
}  // namespace handrail
