// The link's two ages, its quality, and presence.
#include "server/session/ladder.h"

#include <gtest/gtest.h>

#include "server/session/presence.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;

LinkView with(LinkGrade grade, LinkGrade peer_grade) { return {0, grade, peer_grade, true}; }

TEST(Ladder, IsGoodOnlyAfterAWholeSecondBothWays) {
  LadderSettings settings;
  settings.good_for = kSecond;
  LadderState state;
  const LinkView good = with(LinkGrade::kGood, LinkGrade::kExcellent);
  for (int i = 1; i < 1000; ++i) {
    ASSERT_FALSE(ladder_step(settings, true, 0, good, kTick, state).held_good) << i;
  }
  (void)ladder_step(settings, true, 0, good, kTick, state);
  EXPECT_TRUE(ladder_step(settings, true, 0, good, kTick, state).held_good);
  // One fair tick of either direction, or one too old, starts the second afresh.
  for (const LinkView& worse : {with(LinkGrade::kFair, LinkGrade::kExcellent),
                                with(LinkGrade::kExcellent, LinkGrade::kFair)}) {
    LadderState broken = state;
    EXPECT_FALSE(ladder_step(settings, true, 0, worse, kTick, broken).held_good);
    EXPECT_FALSE(ladder_step(settings, true, 0, good, kTick, broken).held_good);
  }
  EXPECT_FALSE(ladder_step(settings, true, 20 * kMillisecond + 1, good, kTick, state).held_good);
}

TEST(Ladder, APoorDirectionHoldsAndNeverMakesALostLinkBetter) {
  for (const LinkView& poor : {with(LinkGrade::kPoor, LinkGrade::kExcellent),
                               with(LinkGrade::kExcellent, LinkGrade::kPoor)}) {
    EXPECT_EQ(rung_of(true, 0, poor), LinkRung::kHold);
    EXPECT_EQ(rung_of(true, 20 * kMillisecond, poor), LinkRung::kHold);
    EXPECT_EQ(rung_of(true, 300 * kMillisecond, poor), LinkRung::kLost);
    EXPECT_EQ(rung_of(true, 2 * kSecond, poor), LinkRung::kClosed);
    EXPECT_EQ(rung_of(false, 0, poor), LinkRung::kNone);
  }
  EXPECT_EQ(rung_of(true, 0, with(LinkGrade::kFair, LinkGrade::kFair)), LinkRung::kFresh);
}

TEST(Ladder, AnOldLoopIsSaidAndFadesTheForceButNeverChangesTheRung) {
  LadderSettings settings;
  settings.fade_loop = 600 * kMillisecond;
  LadderState state;
  LinkView link;
  const auto step = [&](Nanos loop_age) {
    link.loop_age = loop_age;
    return ladder_step(settings, true, kMillisecond, link, kTick, state);
  };
  EXPECT_FALSE(step(100 * kMillisecond).old_loop);
  EXPECT_TRUE(step(100 * kMillisecond + 1).old_loop);
  EXPECT_EQ(step(600 * kMillisecond).force_share, 1.0);
  EXPECT_NEAR(step(650 * kMillisecond).force_share, 0.5, 1e-12);
  EXPECT_EQ(step(700 * kMillisecond).force_share, 0.0);
  for (const Nanos age : {Nanos{0}, kSecond, 10 * kSecond, kForever}) {
    EXPECT_EQ(step(age).rung, LinkRung::kFresh);
  }
  EXPECT_EQ(step(kForever).force_share, 0.0);
  EXPECT_EQ(step(0).force_share, 1.0);
}

TEST(Presence, IsWhatItsConfigurationSays) {
  for (const bool button : {false, true}) {
    for (const Nanos heard : {Nanos{0}, 200 * kMillisecond, 200 * kMillisecond + 1, kForever}) {
      EXPECT_TRUE(present(Presence::kNone, button, heard));
      EXPECT_EQ(present(Presence::kButton, button, heard), button);
      EXPECT_EQ(present(Presence::kHold, button, heard), heard <= 200 * kMillisecond);
    }
  }
}

}  // namespace
}  // namespace handrail
