#include "server/haptic/felt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace handrail {
namespace {

constexpr double kFeltTick = 1e-3;  // [s]

// A hand that drives an arm which touches something with 6 N.
struct Touching {
  HapticInput in;
  HapticState state;

  Touching() {
    in.hand.valid = true;
    in.slave_known = true;
    in.slave_age = kMillisecond;
    in.slave.has_wrench = true;
    in.slave.f_E_S.force = Vec3(0.0, 3.6, -4.8);
    state.lead.session = SessionState::kEngaged;
  }
  HapticCue felt() const { return felt_after(in, state); }
};

TEST(Felt, AContactIsFeltInProportionBetweenItsTwoBounds) {
  Touching t;
  EXPECT_EQ(t.felt(), (HapticCue{Felt::kContact, 0.5}));
  t.in.slave.f_E_S.force *= 100.0;
  EXPECT_EQ(t.felt(), (HapticCue{Felt::kContact, 1.0}));
  t.in.slave.f_E_S.force = Vec3(0.0, 0.0, kLeastFeltContact);
  EXPECT_EQ(t.felt(), HapticCue{});
}

TEST(Felt, AContactThatIsNotOfNowOrNotOursIsNotFelt) {
  const auto expect_nothing = [](const char* why, auto change) {
    Touching t;
    change(t);
    EXPECT_EQ(t.felt(), HapticCue{}) << why;
  };
  expect_nothing("old", [](Touching& t) { t.in.slave_age = kFeltContactStands; });
  expect_nothing("unknown", [](Touching& t) { t.in.slave_known = false; });
  expect_nothing("no sensor", [](Touching& t) { t.in.slave.has_wrench = false; });
  expect_nothing("off", [](Touching& t) { t.state.lead.session = SessionState::kOff; });
  expect_nothing("fault", [](Touching& t) { t.state.lead.session = SessionState::kFault; });
  expect_nothing("no hand", [](Touching& t) { t.in.hand.valid = false; });
  expect_nothing("no number", [](Touching& t) {
    t.in.slave.f_E_S.force.x() = std::numeric_limits<double>::quiet_NaN();
  });
}

TEST(Felt, ACueGoesBeforeContactAndIsStillBetweenItsTrembles) {
  const std::pair<Cue, Felt> all[] = {{Cue::kHold, Felt::kHold},
                                      {Cue::kLost, Felt::kLost},
                                      {Cue::kLimit, Felt::kLimit},
                                      {Cue::kSingularity, Felt::kSingularity}};
  for (const auto& [cue, felt] : all) {
    Touching t;
    std::set<double> strengths;
    int ms = 0;
    (void)t.state.force.cue.step(cue, Cue::kNone, kFeltTick);
    for (; t.felt().what == felt && ms < 2000; ++ms) {
      strengths.insert(t.felt().strength);
      const double force = t.state.force.cue.step(Cue::kNone, Cue::kNone, kFeltTick);
      // What devices with force tremble by is the same.
      if (force != 0.0 && t.felt().what == felt) {
        EXPECT_EQ(t.felt().strength, 1.0) << ms;
      }
    }
    EXPECT_EQ(strengths, (std::set<double>{0.0, 1.0})) << static_cast<int>(cue);
    EXPECT_GT(ms, 300);
    EXPECT_LT(ms, 800);
    EXPECT_EQ(t.felt().what, Felt::kContact) << "afterwards";
  }
}

TEST(Felt, ACueThatIsCutIsOver) {
  Touching t;
  (void)t.state.force.cue.step(Cue::kLimit, Cue::kNone, kFeltTick);
  ASSERT_EQ(t.felt().what, Felt::kLimit);
  t.state.force.cue.cut(Cue::kNone);
  EXPECT_EQ(t.felt().what, Felt::kContact);
}

}  // namespace
}  // namespace handrail
