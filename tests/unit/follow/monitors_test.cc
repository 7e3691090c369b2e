// What says that sensor, encoder or arm are not to be trusted.
#include "server/follow/monitors.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::FollowRig;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kRange = 1000.0;
constexpr double kMonitorCycle = 0.0071;

// Noise of a few counts, as a real sensor's.
Wrench noise(Dice& dice, const Vec3& force = Vec3::Zero()) {
  return {force + dice.within(0.05), dice.within(1e-3)};
}

// The newest reading of a sensor on an arm that stands.
Reason judge(WrenchMonitor& monitor, const Wrench& f) {
  WrenchReading now;
  now.f_E_T = f;
  now.fresh = now.still = true;
  return monitor.judge(BumperSettings(), kRange, kMonitorCycle, now);
}

TEST(WrenchMonitor, ANoisySensorThatRepeatsItselfIsStuckWithinATenthOfASecond) {
  Dice dice(1);
  WrenchMonitor monitor;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(judge(monitor, noise(dice)), Reason::kNone);
  }
  const Wrench stuck = noise(dice);
  int cycles = 0;
  while (judge(monitor, stuck) == Reason::kNone) ASSERT_LT(++cycles, 100);
  EXPECT_LE((cycles + 1) * kMonitorCycle, 0.1);
  EXPECT_EQ(judge(monitor, noise(dice)), Reason::kNone);
}

TEST(WrenchMonitor, BeyondItsRangeIsToldFromSilentAndFromInvalid) {
  Dice dice(2);
  const auto judged = [&](const Wrench& f, bool fresh, bool overrange) {
    WrenchMonitor monitor;
    WrenchReading now;
    now.f_E_T = f;
    now.fresh = fresh;
    now.overrange = overrange;
    return monitor.judge(BumperSettings(), kRange, kMonitorCycle, now);
  };
  const double limit = std::numeric_limits<double>::infinity();
  EXPECT_EQ(judged(noise(dice), true, false), Reason::kNone);
  EXPECT_EQ(judged({Vec3(0, 0, kRange), Vec3::Zero()}, true, false), Reason::kNone);
  EXPECT_EQ(judged({Vec3(0, 0, -1.001 * kRange), Vec3::Zero()}, true, false),
            Reason::kSensorOverrange);
  EXPECT_EQ(judged({Vec3(limit, 0, 0), Vec3::Zero()}, true, false), Reason::kSensorInvalid);
  // A sensor that says so itself has a fault flag: its reading is not valid.
  EXPECT_EQ(judged(noise(dice), false, true), Reason::kSensorOverrange);
  EXPECT_EQ(judged(noise(dice), false, false), Reason::kSensorMissing);
}

TEST(WrenchMonitor, ASpikeOfOneReadingIsDroppedAndAForceThatStaysIsBelieved) {
  Dice dice(3);
  WrenchMonitor monitor;
  (void)judge(monitor, noise(dice));
  EXPECT_EQ(judge(monitor, noise(dice, {0, 0, 300})), Reason::kSensorInvalid);
  EXPECT_EQ(judge(monitor, noise(dice)), Reason::kNone);
  EXPECT_EQ(judge(monitor, noise(dice, {0, 0, 300})), Reason::kSensorInvalid);
  EXPECT_EQ(judge(monitor, noise(dice, {0, 0, 300})), Reason::kNone);
}

// The joints to believe after a cycle in which `q` was measured.
JointVector hears(JointMonitor& monitor, const JointVector& q) {
  monitor.pass(1);
  return monitor.judge(q);
}

TEST(JointMonitor, ABadReadingIsHeldOverAndTheThirdNamesItsJoint) {
  for (const double bad : {kNoNumber, std::numeric_limits<double>::infinity(), 1e300, 2.0}) {
    JointMonitor monitor;
    JointVector q = JointVector::Constant(0.5);
    EXPECT_EQ(hears(monitor, q), q);
    JointVector broken = q;
    broken[3] = bad;
    EXPECT_EQ(hears(monitor, broken), q);
    EXPECT_FALSE(monitor.broken());
    q[0] += 0.03;
    EXPECT_EQ(hears(monitor, q), q);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(hears(monitor, broken), q);
    EXPECT_TRUE(monitor.broken());
    EXPECT_EQ(monitor.joint(), 3);
    EXPECT_EQ(hears(monitor, q), q);
    EXPECT_FALSE(monitor.broken());
  }
}

TEST(JointMonitor, AJointMayHaveMovedInEveryCycleThatWasNotHeard) {
  JointMonitor monitor;
  const JointVector q = JointVector::Constant(0.5);
  hears(monitor, q);
  JointVector moved = q;
  moved[5] += 0.35;
  monitor.pass(2);
  EXPECT_EQ(hears(monitor, moved), q) << "in three cycles";
  EXPECT_EQ(hears(monitor, moved), moved) << "in four";
  monitor.pass(3);
  EXPECT_EQ(hears(monitor, q), q);
  EXPECT_EQ(hears(monitor, moved), q) << "the cycles before are not counted again";
}

// An arm behind a first-order lag, its command a sine of the joints' greatest speed and
// acceleration; after `until` it stops.
int cycles_to_alarm(double lag, int until, int cycles, Dice& dice) {
  FollowingMonitor monitor;
  const FollowingSettings settings;
  JointVector q = JointVector::Zero(), last = q, arm = q;
  monitor.restart(q);
  for (int i = 0; i < cycles; ++i) {
    const double t = i * kMonitorCycle, speed = 4.0, acceleration = 26.0, w = acceleration / speed;
    if (i < until) arm += (last - arm) * (1.0 - std::exp(-kMonitorCycle / lag));
    if (monitor.lost(settings, q,
                     arm + JointVector(JointVector::Constant(dice.between(-1e-4, 1e-4))),
                     kMonitorCycle)) {
      return i;
    }
    last = q;
    q.setZero();
    q[1] = speed / w * std::sin(w * t);
  }
  return cycles;
}

TEST(FollowingMonitor, AnArmOfAnySoundLagIsSilentForTenMinutes) {
  Dice dice(4);
  for (const double lag : {0.001, 0.025, 0.045, 0.070, 0.090}) {
    const int cycles = static_cast<int>(600.0 / kMonitorCycle);
    EXPECT_EQ(cycles_to_alarm(lag, cycles, cycles, dice), cycles) << lag;
  }
}

// A joint anywhere, each way drawn from its limits, and each arm of its own lag and delay.
TEST(FollowingMonitor, AnArmOfAnySoundLagIsSilentWhateverTheMotion) {
  const double speed = 4.0 * kMonitorCycle, change = 26.0 * kMonitorCycle * kMonitorCycle;
  for (int run = 0; run < 200; ++run) {
    Dice dice(static_cast<std::uint32_t>(100 + run));
    const double lag = dice.between(0.001, 0.090);
    FollowingMonitor monitor;
    JointVector q = JointVector::Zero(), last = q, arm = q;
    monitor.restart(q);
    double step = 0.0, wanted = 0.0;
    for (int i = 0; i < 2000; ++i) {
      arm += (last - arm) * (1.0 - std::exp(-kMonitorCycle / lag));
      ASSERT_FALSE(monitor.lost({}, q, arm, kMonitorCycle)) << run << " cycle " << i;
      if (dice.between(0, 1) < 0.05) wanted = dice.between(-speed, speed);
      step += std::clamp(wanted - step, -change, change);
      last = q;
      q[2] += step;
    }
  }
}

TEST(FollowingMonitor, AnArmThatStandsWhileASlowCommandGoesOnIsSeenInTime) {
  FollowingMonitor monitor;
  JointVector q = JointVector::Zero();
  monitor.restart(q);
  // At 0.2 rad/s the slowest sound arm is 22 mrad behind; 11 mrad more are no sound arm.
  int cycles = 0;
  for (; !monitor.lost({}, q, JointVector::Zero(), kMonitorCycle); ++cycles)
    q[1] += 0.2 * kMonitorCycle;
  EXPECT_LT(cycles * kMonitorCycle, 0.25);
  EXPECT_GT(cycles * kMonitorCycle, 0.05);
}

// A slave that starts anew while the arm still comes to where its predecessor sent it.
TEST(FollowingMonitor, AnArmTakenOverInMotionMayArriveAndOneThatNeverDoesIsSeen) {
  for (const bool arrives : {true, false}) {
    FollowingMonitor monitor;
    const JointVector q = JointVector::Zero();
    JointVector arm = JointVector::Constant(0.1);
    monitor.restart(q);
    int cycles = 0;
    for (; cycles < 200; ++cycles) {
      if (arrives) arm *= std::exp(-kMonitorCycle / 0.09);
      if (monitor.lost({}, q, arm, kMonitorCycle)) break;
    }
    if (arrives) {
      EXPECT_EQ(cycles, 200);
    } else {
      EXPECT_LT(cycles * kMonitorCycle, 0.6);
    }
  }
}

TEST(FollowingMonitor, AnArmThatStopsOnItsWayIsSeen) {
  Dice dice(5);
  for (int until = 200; until < 400; until += 7) {
    EXPECT_LT(cycles_to_alarm(0.045, until, until + 60, dice), until + 60) << until;
  }
}

TEST(FollowMonitors, OneNonFiniteJointReadingChangesNothingAndThreeAreAFault) {
  FollowRig rig;
  rig.engage();
  Pose X = rig.tip;
  for (int i = 0; i < 30; ++i) {
    X.p.y() += 1e-3;
    if (i % 5 == 0) rig.in.q_measured[2] = kNoNumber;
    rig.follow(X);
    ASSERT_EQ(rig.out.link.state, SessionState::kEngaged);
    ASSERT_TRUE(rig.out.link.q_measured.allFinite() && is_finite(rig.out.link.X_ST));
  }
  for (int i = 0; i < 3; ++i) {
    rig.in.q_measured[2] = kNoNumber;
    rig.follow(X);
  }
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  EXPECT_EQ(rig.out.link.fault, Reason::kEncoderInvalid);
  EXPECT_EQ(rig.out.link.ledger.joint, 2);
  EXPECT_TRUE(rig.watch.kept());
}

TEST(FollowMonitors, AnArmThatDoesNotMoveIsAFault) {
  FollowRig rig;
  rig.engage();
  const JointVector held = rig.joints();
  Pose X = rig.tip;
  int i = 0;
  for (; i < 200 && rig.out.link.state == SessionState::kEngaged; ++i) {
    X.p.y() += 3e-3;
    rig.in.q_measured = held;
    rig.follow(X);
  }
  EXPECT_LT(i, 100);
  EXPECT_EQ(rig.out.link.fault, Reason::kFollowingError);
  EXPECT_TRUE(rig.watch.kept());
}

TEST(FollowMonitors, AStuckSensorIsAFaultWhereTheSensorIsRequired) {
  for (const bool required : {false, true}) {
    Dice dice(6);
    FollowRig rig;
    rig.settings.sensor_required = required;
    rig.engage();
    for (int i = 0; i < 300; ++i) {
      rig.in.f_E_T = noise(dice);
      rig.cycle();
      ASSERT_EQ(rig.out.link.state, SessionState::kEngaged);
    }
    for (int i = 0; i < 14; ++i) rig.cycle();  // 100 ms of the same reading
    EXPECT_EQ(rig.out.link.state, required ? SessionState::kFault : SessionState::kEngaged);
    EXPECT_EQ(rig.out.link.reason, Reason::kSensorStuck);
    EXPECT_FALSE(rig.out.link.has_wrench);
  }
}

TEST(FollowMonitors, AResetOfAnOpenStopCircuitLatchesItAnewAndIsNotKeptForWhenItCloses) {
  FollowRig rig;
  rig.engage();
  rig.in.stop_input = true;
  rig.cycle();
  EXPECT_EQ(rig.out.link.fault, Reason::kStopInput);
  rig.in.master.desired = Desired::kOff;
  rig.in.master.state = SessionState::kOff;
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  EXPECT_NE(rig.out.link.fault_epoch, rig.in.master.fault_reset);
  rig.in.stop_input = false;
  for (int i = 0; i < 10; ++i) rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kFault);
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.cycle();
  EXPECT_EQ(rig.out.link.state, SessionState::kOff);
}

TEST(FollowMonitors, AResetOfAnotherFaultNamesTheStopCircuitThatIsOpen) {
  FollowRig rig;
  rig.engage();
  rig.in.fault = Reason::kRobotBadPacket;
  rig.cycle();
  rig.in.fault = Reason::kNone;
  rig.in.stop_input = true;
  rig.cycle();
  EXPECT_EQ(rig.out.link.fault, Reason::kRobotBadPacket);
  rig.in.master.fault_reset = rig.out.link.fault_epoch;
  rig.cycle();
  EXPECT_EQ(rig.out.link.fault, Reason::kStopInput);
}

}  // namespace
}  // namespace handrail
