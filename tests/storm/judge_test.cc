#include "tests/storm/judge.h"

#include <gmock/gmock.h>

#include "server/model/rv2a_limits.h"

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const double kT = to_seconds(kMxtPeriod);
const double kJolt = rv2a_limits().max_jerk[0] * kT * kT * kT;

// J1 goes out in a quarter of a second and back to rest, gently.
struct Drive {
  Drive() {
    tap.period = kMxtPeriod;
    add(0.0, 0);
  }
  void add(double by, std::uint16_t did) {
    TapRecord r;
    r.number = r.again = tap.records.size() + 1;
    r.at = kSecond + static_cast<Nanos>(tap.records.size()) * kMxtPeriod;
    r.did = did;
    r.target[0] = (tap.records.empty() ? 0.0 : tap.records.back().target[0]) + by;
    r.measured = r.target;
    tap.records.push_back(r);
  }
  void target(double by) { add(by, kTapAccepted | kTapSession); }
  void speed_up(int cycles, double change) {
    for (int i = 0; i < cycles; ++i) target(v += change);
  }
  void sound() {
    speed_up(3, 0.9 * kJolt);
    speed_up(30, 0.0);
    speed_up(3, -0.9 * kJolt);
    target(0.0);
  }
  Nanos end() const { return tap.records.back().at; }
  Figures judge() { return judge_tap(tap, forbidden, found); }

  TapFile tap;
  double v = 0.0;
  std::vector<Forbidden> forbidden;
  std::vector<Violation> found;
};

TEST(StormJudge, ASoundDriveIsNotViolated) {
  Drive d;
  d.sound();
  const Figures f = d.judge();
  EXPECT_THAT(d.found, IsEmpty());
  EXPECT_EQ(f.targets, 37u);
  EXPECT_EQ(f.halts, 0u);
  EXPECT_GT(f.jerk, 0.8);
}

// A fast motion: one cycle gets nothing; the packet that comes next goes on by one step.
Figures one_cycle_without(Drive& d, double period_share, int cycles, std::uint16_t lost) {
  d.speed_up(20, 0.9 * kJolt);
  d.speed_up(10, 0.0);
  for (int i = 0; i < cycles; ++i) d.add(0.0, kTapSession);
  d.target(d.v);
  TapRecord& r = d.tap.records.back();
  r.came = static_cast<std::uint16_t>(period_share * static_cast<double>(kMxtPeriod) /
                                      static_cast<double>(kMicrosecond));
  r.lost = lost;
  d.speed_up(10, 0.0);
  d.speed_up(20, -0.9 * kJolt);
  d.target(0.0);
  return d.judge();
}

TEST(StormJudge, ACommandThatCameAfterItsCycleIsNotTheSlavesHold) {
  Drive d;
  const Figures f = one_cycle_without(d, 0.1, 1, 0);
  EXPECT_THAT(d.found, IsEmpty());
  EXPECT_EQ(f.breaches, 0u);
  EXPECT_EQ(f.late, 1u);
  EXPECT_EQ(f.halts, 0u);
}

// A slave that stood for two cycles plans both at once; that command came after the second.
TEST(StormJudge, ACommandForTwoCyclesThatCameAfterThemIsNotTheSlavesHold) {
  const auto judged = [](double steps, int cycles, std::uint16_t came) {
    Drive d;
    d.speed_up(20, 0.9 * kJolt);
    d.speed_up(10, 0.0);
    for (int i = 0; i < cycles; ++i) d.add(0.0, kTapSession);
    d.target(steps * d.v);
    d.tap.records.back().came = came;
    d.speed_up(10, 0.0);
    d.speed_up(20, -0.9 * kJolt);
    d.target(0.0);
    return d.judge();
  };
  EXPECT_EQ(judged(2.0, 2, 2000).breaches, 0u);
  EXPECT_EQ(judged(2.0, 2, 2000).late, 1u);
  EXPECT_GT(judged(2.0, 2, 6500).breaches, 0u) << "sent without a reply";
  EXPECT_GT(judged(2.0, 3, 2000).breaches, 0u) << "one cycle came late, not two";
  EXPECT_GT(judged(1.0, 2, 2000).breaches, 0u);
}

TEST(StormJudge, ALateCommandMayFollowALostOne) {
  Drive d;
  d.speed_up(20, 0.9 * kJolt);
  d.speed_up(10, 0.0);
  d.add(0.0, kTapSession);
  d.tap.records.back().lost = 1;
  d.add(0.0, kTapSession);
  d.target(2.0 * d.v);
  d.speed_up(10, 0.0);
  d.speed_up(20, -0.9 * kJolt);
  d.target(0.0);
  EXPECT_EQ(d.judge().late, 1u);
  EXPECT_THAT(d.found, IsEmpty());
}

// The first target of a start is lost, the second so late that it was not sent.
TEST(StormJudge, ACommandThatWasLeftOutIsAsGoodAsLost) {
  Drive d;
  d.sound();
  for (int i = 0; i < 60; ++i) d.add(0.0, kTapSession);
  d.tap.records.back().lost = 1;
  d.add(0.0, kTapSession);
  d.target((1 + 3 + 6) * 0.9 * kJolt);
  d.tap.records.back().came = 6400;
  d.v = 6 * 0.9 * kJolt;
  for (const int change : {2, 1, 0, -1, -2, -3, -2, -1}) d.speed_up(1, change * 0.9 * kJolt);
  d.target(0.0);
  EXPECT_EQ(d.judge().late, 0u);
  EXPECT_THAT(d.found, IsEmpty());
}

TEST(StormJudge, WhateverElseAMotionGoesOnAfterIsJudged) {
  Drive silent, longer, lost;
  EXPECT_GT(one_cycle_without(silent, 0.9, 1, 0).breaches, 0u) << "sent without a reply";
  EXPECT_GT(one_cycle_without(longer, 0.1, 2, 0).breaches, 0u) << "two cycles";
  EXPECT_GT(one_cycle_without(lost, 0.1, 1, 1).breaches, 0u) << "one was lost";
}

TEST(StormJudge, ALateCommandExcusesNoLargerOne) {
  Drive d;
  d.speed_up(20, 0.9 * kJolt);
  d.speed_up(10, 0.0);
  d.add(0.0, kTapSession);
  d.target(d.v + 3.0 * kJolt);
  EXPECT_EQ(d.judge().late, 0u);
  EXPECT_THAT(d.found, SizeIs(1));
}

TEST(StormJudge, NamesALimitOnceACauseWithItsPlace) {
  Drive d;
  d.sound();
  for (int i = 0; i < 40; ++i) d.add(0.0, kTapSession);
  d.target(5.0 * kJolt);
  d.target(5.0 * kJolt);
  const Figures f = d.judge();
  EXPECT_GE(f.breaches, 1u);
  ASSERT_THAT(d.found, SizeIs(1));
  EXPECT_EQ(d.found[0].at, d.end() - kMxtPeriod);
  EXPECT_THAT(d.found[0].what, HasSubstr("J1"));
  EXPECT_THAT(d.found[0].what, HasSubstr("5.00 of jerk"));
  // 40 held, and the last two of the sound drive moved nothing.
  EXPECT_THAT(d.found[0].what, HasSubstr("43 cycles after the last step"));
  EXPECT_THAT(trace(d.tap, d.found[0].at, 2, 1), HasSubstr("+7.1 ms  AS"));
}

TEST(StormJudge, AStartWhoseFirstTargetsWereLostIsOne) {
  for (const std::uint16_t lost : std::initializer_list<std::uint16_t>{0, 1}) {
    Drive d;
    d.sound();
    for (int i = 0; i < 40; ++i) d.add(0.0, kTapSession);
    d.tap.records.back().lost = lost;
    d.target(0.9 * kJolt + 1.8 * kJolt);
    d.target(2.7 * kJolt);
    EXPECT_EQ(d.judge().breaches == 0, lost == 1);
  }
}

// With the first step lost, 0.35 and 0.6 come as one; the next is 0.6.
TEST(StormJudge, AStartIsReadAsTheLaterTargetsTellIt) {
  for (const std::uint16_t lost : std::initializer_list<std::uint16_t>{0, 1}) {
    Drive d;
    d.sound();
    for (int i = 0; i < 40; ++i) d.add(0.0, kTapSession);
    d.tap.records.back().lost = lost;
    d.target(0.95 * kJolt);
    d.target(0.6 * kJolt);
    EXPECT_EQ(d.judge().breaches == 0, lost == 1);
  }
}

TEST(StormJudge, NamesAMotionWhereNothingMayMove) {
  Drive d;
  d.sound();
  d.forbidden = {{0, 2 * kMxtPeriod, "before"}, {d.end(), d.end() + kSecond, "after"}};
  EXPECT_EQ(d.judge().breaches, 0u);
  EXPECT_THAT(d.found, IsEmpty());
  d.forbidden.push_back({kSecond + 10 * kMxtPeriod, d.end(), "the stop was confirmed"});
  (void)d.judge();
  ASSERT_THAT(d.found, SizeIs(1));
  EXPECT_EQ(d.found[0].at, kSecond + 11 * kMxtPeriod);
  EXPECT_THAT(d.found[0].what, HasSubstr("the stop was confirmed"));
}

TEST(StormJudge, AnAlarmIsTheControllersOwnOnlyWhenItTimesOut) {
  Drive d;
  d.sound();
  d.add(0.0, kTapAlarm | kTapClosed);
  d.tap.records.back().alarm = static_cast<std::uint8_t>(AlarmKind::kTimeOut);
  (void)d.judge();
  EXPECT_THAT(d.found, IsEmpty());
  d.tap.records.back().alarm = static_cast<std::uint8_t>(AlarmKind::kOverSpeed);
  (void)d.judge();
  EXPECT_THAT(d.found, SizeIs(1));
}

// Without its first records a sound drive begins in full motion.
TEST(StormJudge, ARingIsJudgedFromItsFirstStandstillOn) {
  Drive d;
  d.sound();
  d.tap.records.erase(d.tap.records.begin(), d.tap.records.begin() + 10);
  EXPECT_EQ(d.judge().targets, 0u);
  EXPECT_THAT(d.found, IsEmpty());
  for (int i = 0; i < 40; ++i) d.add(0.0, kTapSession);
  d.target(5.0 * kJolt);
  EXPECT_EQ(d.judge().breaches, 1u);
  EXPECT_THAT(d.found, SizeIs(1));
}

TEST(StormJudge, KnowsWhereTheArmWas) {
  Drive d;
  d.sound();
  JointVector q;
  EXPECT_FALSE(measured_at(d.tap, kSecond - 1, q));
  ASSERT_TRUE(measured_at(d.tap, kSecond + 5 * kMxtPeriod + 1, q));
  EXPECT_EQ(q[0], d.tap.records[5].measured[0]);
  EXPECT_FALSE(measured_at(d.tap, d.end() + kSecond, q));
}

}  // namespace
}  // namespace handrail::storm
