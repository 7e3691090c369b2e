// The judge of stops, on taps and wires made up: what is sound is found so, and each rule is broken
// once.
#include "tests/faults/link_judge.h"

#include <gmock/gmock.h>

#include "server/model/rv2a_limits.h"

namespace handrail::faults {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const double kT = to_seconds(kMxtPeriod);
const double kJolt = 0.9 * rv2a_limits().max_jerk[0] * kT * kT * kT;

// A link on which each side hears the other every millisecond, but for gaps; J1 that is told what
// the test says, a target a cycle.
class LinkJudge : public ::testing::Test {
 protected:
  LinkJudge() {
    tap.period = kMxtPeriod;
    cycle(0.0, 0);
    story.engages.push_back({now() - 100 * kMillisecond, now()});
    story.master_starts.push_back(0);
  }
  Nanos now() const { return kSecond + static_cast<Nanos>(tap.records.size()) * kMxtPeriod; }
  void cycle(double by, std::uint16_t did) {
    TapRecord r;
    r.number = r.again = tap.records.size() + 1;
    r.at = now();
    r.did = did;
    r.came = 7000;
    r.target[0] = (tap.records.empty() ? 0.0 : tap.records.back().target[0]) + by;
    tap.records.push_back(r);
  }
  void target(double by) { cycle(by, kTapAccepted | kTapSession); }
  void change(int cycles, double by) {
    for (int i = 0; i < cycles; ++i) target(v += by);
  }
  void start() { change(4, kJolt); }
  void go(Nanos span) { change(static_cast<int>(span / kMxtPeriod), 0.0); }
  void brake() {
    change(4, -kJolt);
    v = 0.0;
  }
  void stand(Nanos span) {
    for (Nanos left = span; left > 0; left -= kMxtPeriod) target(0.0);
  }

  LinkVerdict judge() {
    WireTruth truth;
    std::uint64_t number = 0;
    for (Nanos at = kSecond - 200 * kMillisecond; at < now(); at += kMillisecond) {
      const auto in = [at](const std::vector<Span>& gaps) {
        return std::any_of(gaps.begin(), gaps.end(),
                           [at](const Span& g) { return at > g.from && at < g.to; });
      };
      ++number;
      if (!in(to_slave_gaps)) truth.to_slave.push_back({at, at, number});
      if (!in(to_master_gaps)) truth.to_master.push_back(at);
    }
    return judge_link(tap, truth, story, LatenessLog(late));
  }
  std::string first(const LinkVerdict& verdict) {
    return verdict.violations.empty() ? "" : verdict.violations[0].what;
  }

  TapFile tap;
  double v = 0.0;
  Story story;
  std::vector<Span> to_slave_gaps, to_master_gaps;
  std::vector<Late> late;
};

TEST_F(LinkJudge, ADriveOverASoundLinkIsNotViolated) {
  start();
  go(500 * kMillisecond);
  brake();
  stand(200 * kMillisecond);
  const LinkVerdict verdict = judge();
  EXPECT_THAT(verdict.violations, IsEmpty());
  EXPECT_EQ(verdict.report.stops, 0u);
  EXPECT_EQ(verdict.trips, 0u);
}

TEST_F(LinkJudge, AStopInTimeIsCountedAndGoesOnByItself) {
  start();
  go(200 * kMillisecond);
  to_slave_gaps.push_back({now(), now() + 100 * kMillisecond});
  go(20 * kMillisecond);
  brake();
  stand(100 * kMillisecond);
  start();
  go(100 * kMillisecond);
  const LinkVerdict verdict = judge();
  EXPECT_THAT(verdict.violations, IsEmpty()) << first(verdict);
  EXPECT_EQ(verdict.report.stops, 1u);
  EXPECT_EQ(verdict.report.resumed, 1u);
  EXPECT_EQ(verdict.short_gaps, 1u);
  EXPECT_EQ(verdict.trips, 1u);
  EXPECT_EQ(verdict.long_gaps, 0u);
  EXPECT_GT(verdict.report.worst.took, 25 * kMillisecond);
  EXPECT_LT(verdict.report.worst.took, verdict.report.worst.allowed);
}

TEST_F(LinkJudge, AnArmThatGoesOnWithoutNewsStopsTooLate) {
  start();
  go(200 * kMillisecond);
  to_slave_gaps.push_back({now(), now() + 150 * kMillisecond});
  go(140 * kMillisecond);
  const LinkVerdict verdict = judge();
  ASSERT_THAT(verdict.violations, SizeIs(1));
  EXPECT_THAT(first(verdict), HasSubstr("still moving after its stop"));
  EXPECT_GT(verdict.report.of(Breach::kLateStop), 0u);
}

// The bound is 20 + 7.1 + 2 ms and what the joint needs: a few milliseconds beyond are violated,
// unless the machine was late by as much.
TEST_F(LinkJudge, WhatTheMachineWasLateIsGrantedAndNoMore) {
  start();
  go(200 * kMillisecond);
  const Nanos from = now();
  to_slave_gaps.push_back({from, from + 190 * kMillisecond});
  go(100 * kMillisecond);
  brake();
  stand(50 * kMillisecond);
  EXPECT_THAT(judge().violations, SizeIs(1));
  late = {{from + 30 * kMillisecond, 40 * kMillisecond}};
  const LinkVerdict granted = judge();
  EXPECT_THAT(granted.violations, IsEmpty()) << first(granted);
  EXPECT_EQ(granted.lateness, 40 * kMillisecond);
  late = {{from + 30 * kMillisecond, 5 * kMillisecond}};
  EXPECT_THAT(judge().violations, SizeIs(1));
}

// A controller that got nothing while it braked holds the arm, and time passes.
TEST_F(LinkJudge, CyclesThatTheControllerHeldAreGranted) {
  start();
  go(200 * kMillisecond);
  to_slave_gaps.push_back({now(), now() + 190 * kMillisecond});
  go(20 * kMillisecond);
  for (int i = 0; i < 12; ++i) cycle(0.0, kTapSession);
  brake();
  const LinkVerdict verdict = judge();
  EXPECT_THAT(verdict.violations, IsEmpty()) << first(verdict);
  EXPECT_EQ(verdict.held, 12u);
}

TEST_F(LinkJudge, AfterALongGapNothingMovesUntilSomebodyEngages) {
  start();
  go(200 * kMillisecond);
  to_slave_gaps.push_back({now(), now() + 300 * kMillisecond});
  go(20 * kMillisecond);
  brake();
  stand(400 * kMillisecond);
  const Nanos back = now();
  start();
  const LinkVerdict verdict = judge();
  ASSERT_THAT(verdict.violations, SizeIs(1));
  EXPECT_THAT(first(verdict), HasSubstr("moved while nobody led it"));
  EXPECT_EQ(verdict.long_gaps, 1u);
  story.engages.push_back({back - 50 * kMillisecond, back});
  EXPECT_THAT(judge().violations, IsEmpty());
}

TEST_F(LinkJudge, AMasterThatHearsNothingLeadsNobody) {
  start();
  go(200 * kMillisecond);
  to_master_gaps.push_back({now(), now() + 150 * kMillisecond});
  go(140 * kMillisecond);
  const LinkVerdict verdict = judge();
  ASSERT_THAT(verdict.violations, SizeIs(1));
  EXPECT_EQ(verdict.short_gaps, 0u);
}

// The master says no longer to move just before the rig gets a command to begin: 2 ms are the way
// of a command, beyond them it should have been heeded.
TEST_F(LinkJudge, AnArmThatStandsMayBeginByWhatWasHeardACommandsWayBefore) {
  start();
  go(100 * kMillisecond);
  brake();
  stand(100 * kMillisecond);
  const Nanos begins = now();
  target(kJolt);
  stand(100 * kMillisecond);
  const auto told_before = [&](Nanos span) {
    const Nanos told = begins - span;
    to_master_gaps = {{told - 22 * kMillisecond, told + 50 * kMillisecond}};
    return judge();
  };
  EXPECT_THAT(told_before(kMillisecond).violations, IsEmpty());
  const LinkVerdict verdict = told_before(5 * kMillisecond);
  ASSERT_THAT(verdict.violations, SizeIs(1));
  EXPECT_THAT(first(verdict), HasSubstr("moved while nobody led it"));
}

TEST_F(LinkJudge, AMasterThatHeardNothingForLongNeedsAnOperator) {
  start();
  go(100 * kMillisecond);
  to_master_gaps.push_back({now(), now() + 300 * kMillisecond});
  go(20 * kMillisecond);
  brake();
  stand(400 * kMillisecond);
  start();
  EXPECT_THAT(judge().violations, SizeIs(1));
  EXPECT_EQ(judge().long_gaps, 1u);
}

TEST_F(LinkJudge, ThatItMustStopHoldsUntilAnEngage) {
  start();
  go(100 * kMillisecond);
  story.must_stop.push_back(now());
  brake();
  stand(300 * kMillisecond);
  EXPECT_THAT(judge().violations, IsEmpty());
  const Nanos again = now();
  start();
  EXPECT_THAT(judge().violations, SizeIs(1));
  story.engages.push_back({again - 30 * kMillisecond, again});
  EXPECT_THAT(judge().violations, IsEmpty());
}

TEST_F(LinkJudge, ANewMasterLeadsOnlyAfterAnEngage) {
  start();
  go(100 * kMillisecond);
  brake();
  stand(100 * kMillisecond);
  to_slave_gaps.push_back({now(), now() + 100 * kMillisecond});
  story.master_starts.push_back(now() + 50 * kMillisecond);
  stand(400 * kMillisecond);
  start();
  EXPECT_THAT(judge().violations, SizeIs(1));
  story.master_starts.pop_back();
  EXPECT_THAT(judge().violations, IsEmpty()) << "the same master goes on";
}

TEST_F(LinkJudge, WhatFloat32RoundsIsNoMotion) {
  story.engages.clear();
  target(1e-8);
  target(-2e-8);
  EXPECT_THAT(judge().violations, IsEmpty());
  // What creeps is one.
  for (int i = 0; i < 20; ++i) target(1e-7);
  EXPECT_THAT(judge().violations, SizeIs(1));
}

TEST_F(LinkJudge, AGapThatTheMachineMadeIsNoTripOfTheNetwork) {
  start();
  go(100 * kMillisecond);
  brake();
  const Nanos from = now();
  to_slave_gaps.push_back({from, from + 40 * kMillisecond});
  to_master_gaps = to_slave_gaps;
  stand(100 * kMillisecond);
  late = {{from, 39 * kMillisecond}};
  EXPECT_EQ(judge().trips, 0u);
  late = {{from, kSecond}};
  EXPECT_EQ(judge().long_gaps, 2u) << "that one, at either side, and none of a millisecond";
  to_master_gaps.clear();
  EXPECT_EQ(judge().short_gaps, 1u);
}

}  // namespace
}  // namespace handrail::faults
