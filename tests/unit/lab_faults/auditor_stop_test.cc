// The auditor on where a tip may be that a tool, or another command, finds on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/motion/jerk_law.h"
#include "tests/unit/lab_faults/audited_stream.h"

namespace handrail {
namespace {

constexpr double kHastens = 0.008;  // of J1 in a cycle [rad]

// J1's limits in cycles, as much of them as `share`.
AxisLimits j1(double share) {
  return {1.0, share * limits().joints.max_acceleration[0] * kDt * kDt,
          share * limits().max_jerk[0] * kDt * kDt * kDt};
}

// The steps of a stop of J1 with `share` of its limits.
std::vector<double> stop_steps(double step, double change, double share) {
  std::vector<double> steps;
  while (step != 0.0 || change != 0.0) {
    change = stop_change(j1(share), step, change);
    step += change;
    steps.push_back(step);
  }
  return steps;
}

// A stream whose tip goes along y, faster with every cycle, and follows its commands.
struct Hastening : Stream {
  double step = 0.0, change = 0.0;
  explicit Hastening(double fast, double spin = 0.0) {
    while (step < fast) {
      change = std::min(change + j1(0.9).jerk, j1(0.9).acceleration);
      q[5] += spin;
      go(step + change);
    }
  }
  void ask(double ahead) {
    JointVector there = q;
    there[0] += ahead;
    state.X_SU = forward(limits().arm, there);
  }
  void go(double next) {
    ask(10.0 * next);
    step = next;
    cycle(next);
  }
};

// The wrist turns fast and gives the stop its time. In it the tip first lets its acceleration fade,
// then brakes: longer than an even stop, and as soon over.
TEST(AuditorTest, AToolIsLeftByAsMuchAsAStopTakesThatIsOverInTime) {
  const double spin = 0.5 * limits().joints.max_speed[5] * kDt;  // due in 17.6 cycles
  for (const int fades : {8, 14}) {                              // cycles; then 8 to 10 more
    Hastening s(0.001, spin);
    s.state.position_tool = line_through(s.auditor.tip());
    s.ask(0.5);
    double step = s.step;
    int left = 16;
    const auto brake = [&](double next) {
      s.q[5] += std::max(0, left--) * spin / 17.0;
      s.cycle(step = next);
    };
    for (int i = fades - 1; i > 0; --i) brake(step + i * s.change / fades);
    for (const double next : stop_steps(step, 0.0, 0.95)) brake(next);
    EXPECT_EQ(s.report().of(Breach::kOffTool) > 0, fades > 8) << fades;
  }
}

// What a stop might have taken, but did not, is no leave to go there later: whatever is asked.
TEST(AuditorTest, ATipThatHasStoppedBesideANewToolGoesNoFurther) {
  for (const bool goes_on : {false, true}) {
    Hastening s(kHastens);
    s.state.position_tool = line_through(s.auditor.tip());
    s.ask(0.5);
    const double there = s.q[0];
    for (const double step : stop_steps(s.step, s.change, 0.95)) s.cycle(step);
    const double stopped = s.q[0] - there;
    for (int i = 0; i < 20; ++i) s.cycle();
    // As far again as a tenth of the stop.
    for (int i = 0; goes_on && i < 20; ++i) s.cycle(0.1 * stopped / 20.0);
    EXPECT_EQ(s.report().of(Breach::kOffTool) > 0, goes_on);
  }
}

// The tip stops away from a place out of reach; that then goes on a little.
TEST(AuditorTest, ATipThatTurnsMayBeAsFarAwayAsItsStopTookItWhileWhatIsAskedGoesOn) {
  for (const bool goes_on : {false, true}) {
    Hastening s(kHastens);
    s.state.X_SU.p = Vec3(0.3, -3.0, 0.5);
    for (const double step : stop_steps(s.step, s.change, 0.95)) {
      if (step < 0.2 * kHastens) s.state.X_SU.p.z() += 1e-4;
      s.cycle(step);
    }
    for (int i = 0; i < 20; ++i) {
      s.state.X_SU.p.z() += 1e-4;
      s.cycle(goes_on ? 0.5 * kHastens : 0.0);
    }
    EXPECT_EQ(s.report().of(Breach::kUnasked) > 0, goes_on);
  }
}

// Out of reach to one side is asked, and a line beside the tip leads it to the other.
TEST(AuditorTest, ATipMayGoToItsToolAwayFromWhatIsAsked) {
  enum class Way { kToTool, kWithoutTool, kAlongTool };
  for (const Way way : {Way::kToTool, Way::kWithoutTool, Way::kAlongTool}) {
    Stream s;
    const Vec3 start = s.auditor.tip();
    s.state.X_SU.p = start + Vec3(0.0, -2.0, 0.0);
    for (int i = 0; i < 3; ++i) s.cycle();
    if (way != Way::kWithoutTool) {
      s.state.position_tool = line_through(start + Vec3(0.0, 0.03, 0.0));
      if (way == Way::kAlongTool) s.state.position_tool.direction_S = Vec3::UnitY();
    }
    for (int i = 0; i < 60; ++i) s.cycle(0.001);
    EXPECT_EQ(s.report().of(Breach::kUnasked) > 0, way != Way::kToTool) << static_cast<int>(way);
  }
}

}  // namespace
}  // namespace handrail
