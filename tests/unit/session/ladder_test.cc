// The link's two ages, its quality, and presence.
#include "server/session/ladder.h"

#include <gtest/gtest.h>

#include "server/session/presence.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;

LinkView with(int received, int peer_received) { return {0, 0, received, peer_received}; }

// What the link did for so many milliseconds of ten, in turn, until a second is full twice over.
LadderStep after(const LinkView& one, Nanos age, int of_ten, const LinkView& other) {
  LadderSettings settings;
  settings.good_for = kSecond;
  LadderState state;
  LadderStep step;
  for (int i = 0; i < 2000; ++i) {
    const bool first = i % 10 < of_ten;
    step = ladder_step(settings, true, first ? age : 0, first ? one : other, kTick, state);
  }
  return step;
}

TEST(Ladder, IsGoodOnlyAfterAWholeSecond) {
  LadderSettings settings;
  settings.good_for = kSecond;
  LadderState state;
  for (int i = 1; i < 1000; ++i) {
    const LadderStep step = ladder_step(settings, true, 0, LinkView(), kTick, state);
    ASSERT_FALSE(step.good) << i;
    ASSERT_NEAR(step.shares.heard, 1e-3 * i, 1e-9);
  }
  EXPECT_TRUE(ladder_step(settings, true, 0, LinkView(), kTick, state).good);
  // A gap that loses the link begins it anew, here or there; one that is held through does not.
  LinkView unheard;
  unheard.peer_age = 200 * kMillisecond + 1;
  LadderState there = state, held = state;
  EXPECT_FALSE(ladder_step(settings, true, 0, unheard, kTick, there).good);
  EXPECT_FALSE(ladder_step(settings, true, 0, LinkView(), kTick, there).good);
  EXPECT_TRUE(ladder_step(settings, true, 200 * kMillisecond, LinkView(), kTick, held).good);
  EXPECT_FALSE(ladder_step(settings, true, 200 * kMillisecond + 1, LinkView(), kTick, state).good);
  EXPECT_FALSE(ladder_step(settings, true, 0, LinkView(), 0.9, state).good);
  EXPECT_TRUE(ladder_step(settings, true, 0, LinkView(), 0.1, state).good) << "time, not ticks";
}

TEST(Ladder, AsksForAShareOfTimeWithNewsAndOfDatagramsThatCame) {
  constexpr Nanos kOld = 20 * kMillisecond + 1;
  LinkView old_there;
  old_there.peer_age = kOld;
  // One millisecond of ten is 10 % and too much; of a whole second 8 % is not.
  const LadderStep here = after(LinkView(), kOld, 1, LinkView());
  EXPECT_FALSE(here.good);
  EXPECT_NEAR(here.shares.held, 0.1, 1e-3);
  EXPECT_EQ(here.shares.peer_held, 0.0);
  const LadderStep there = after(old_there, 0, 1, LinkView());
  EXPECT_FALSE(there.good);
  EXPECT_NEAR(there.shares.peer_held, 0.1, 1e-3);
  EXPECT_TRUE(after(LinkView(), kOld - 1, 10, LinkView()).good);
  EXPECT_TRUE(after(with(75, 100), 0, 10, {}).good);
  EXPECT_FALSE(after(with(74, 100), 0, 10, {}).good);
  EXPECT_FALSE(after(with(100, 74), 0, 10, {}).good);
  EXPECT_NEAR(after(with(100, 74), 0, 10, {}).shares.peer_lost, 0.26, 1e-9);
  // The mean of the second counts, not its worst moment.
  EXPECT_TRUE(after(with(60, 100), 0, 5, with(90, 100)).good);
  EXPECT_FALSE(after(with(60, 100), 0, 7, with(90, 100)).good);
}

TEST(Ladder, OneGapIsForgottenAfterASecond) {
  LadderSettings settings;
  settings.good_for = kSecond;
  LadderState state;
  const auto run = [&](int ms, Nanos age) {
    LadderStep step;
    for (int i = 0; i < ms; ++i) step = ladder_step(settings, true, age, LinkView(), kTick, state);
    return step.good;
  };
  ASSERT_TRUE(run(1000, 0));
  EXPECT_TRUE(run(89, 21 * kMillisecond));
  EXPECT_FALSE(run(3, 21 * kMillisecond));
  EXPECT_FALSE(run(900, 0));
  EXPECT_TRUE(run(110, 0));
}

TEST(Ladder, APoorDirectionHoldsAndNeverMakesALostLinkBetter) {
  for (const LinkView& poor : {with(39, 100), with(100, 39)}) {
    EXPECT_EQ(rung_of(true, 0, poor), LinkRung::kHold);
    EXPECT_EQ(rung_of(true, 20 * kMillisecond, poor), LinkRung::kHold);
    EXPECT_EQ(rung_of(true, 300 * kMillisecond, poor), LinkRung::kLost);
    EXPECT_EQ(rung_of(true, 2 * kSecond, poor), LinkRung::kClosed);
    EXPECT_EQ(rung_of(false, 0, poor), LinkRung::kNone);
  }
  EXPECT_EQ(rung_of(true, 0, with(40, 40)), LinkRung::kFresh);
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
