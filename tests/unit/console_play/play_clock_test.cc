// Which moment is shown when: a clock that plays, pauses, seeks and changes its speed.
#include "client/console/play/play_clock.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "server/base/random.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using Is = PlayState::Is;

constexpr Nanos kLength = 90 * kSecond;

TEST(PlayClock, BeginsPausedAndPlaysToItsEnd) {
  PlayClock clock(kLength);
  EXPECT_EQ(clock.state(500 * kSecond).position, 0);
  EXPECT_EQ(clock.state(500 * kSecond).is, Is::kPaused);
  ASSERT_TRUE(clock.take({true, {}, {}}, 500 * kSecond));
  EXPECT_EQ(clock.state(510 * kSecond).position, 10 * kSecond);
  EXPECT_EQ(clock.state(510 * kSecond).is, Is::kPlaying);
  EXPECT_EQ(clock.state(590 * kSecond - 1).is, Is::kPlaying);
  EXPECT_EQ(clock.state(590 * kSecond).is, Is::kEnded);
  EXPECT_EQ(clock.state(999 * kSecond).position, kLength);
  ASSERT_TRUE(clock.take({true, {}, {}}, 1000 * kSecond));
  EXPECT_EQ(clock.state(1001 * kSecond).position, kSecond) << "again, from the beginning on";
  EXPECT_EQ(clock.state(1001 * kSecond).jumps, 1u);
}

TEST(PlayClock, AtItsEndOneCanGoBackAndItGoesOn) {
  PlayClock clock(kLength);
  ASSERT_TRUE(clock.take({true, kLength + kSecond, {}}, 0));
  EXPECT_EQ(clock.state(1).is, Is::kEnded);
  ASSERT_TRUE(clock.take({{}, 80 * kSecond, {}}, kSecond));
  EXPECT_EQ(clock.state(2 * kSecond).is, Is::kPlaying);
  EXPECT_EQ(clock.state(2 * kSecond).position, 81 * kSecond);
  ASSERT_TRUE(clock.take({false, {}, {}}, 2 * kSecond));
  ASSERT_TRUE(clock.take({{}, -5, {}}, 3 * kSecond));
  EXPECT_EQ(clock.state(9 * kSecond).position, 0);
  EXPECT_EQ(clock.state(9 * kSecond).is, Is::kPaused);
}

TEST(PlayClock, OnlyItsSpeedsAreTakenAndARefusedOrderChangesNothing) {
  PlayClock clock(kLength);
  for (const double speed : {0.0, -1.0, 0.0999, 10.001, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    const Status taken = clock.take({true, 5 * kSecond, speed}, kSecond);
    ASSERT_FALSE(taken) << speed;
    EXPECT_THAT(taken.message(), HasSubstr("expected 0.1 to 10"));
  }
  EXPECT_EQ(clock.state(7 * kSecond).position, 0);
  EXPECT_EQ(clock.state(7 * kSecond).orders, 0u);
  for (const double speed : {0.1, 1.0, 10.0}) EXPECT_TRUE(clock.take({{}, {}, speed}, kSecond));
}

// Against the sum of the ways that it went, by small steps.
TEST(PlayClock, HoweverItIsDrivenItsPlaceIsTheSumOfItsWays) {
  Random random(11);
  for (int run = 0; run < 50; ++run) {
    PlayClock clock(kLength);
    double at = 0.0, speed = 1.0;
    bool playing = false;
    std::uint32_t jumps = 0;
    Nanos now = static_cast<Nanos>(random.bits() % 1'000'000'000'000);
    for (int i = 0; i < 400; ++i) {
      PlayOrder order;
      if (random.bits() % 4 == 0) order.playing = random.bits() % 3 != 0;
      if (random.bits() % 8 == 0) order.speed = 0.1 + 9.9 * random.uniform();
      if (random.bits() % 16 == 0) {
        order.position = static_cast<Nanos>(random.uniform() * 1.2 * kLength) - kSecond;
      }
      const bool ended = at >= to_seconds(kLength) - 1e-9;
      ASSERT_TRUE(clock.take(order, now));
      if (order.position) {
        at = std::min(std::max(to_seconds(*order.position), 0.0), to_seconds(kLength));
        ++jumps;
      } else if (order.playing.value_or(false) && ended) {
        at = 0.0;
        ++jumps;
      }
      playing = order.playing.value_or(playing);
      speed = order.speed.value_or(speed);
      const auto step = static_cast<Nanos>(random.bits() % 3'000'000'000);
      now += step;
      if (playing) at = std::min(at + speed * to_seconds(step), to_seconds(kLength));
      const PlayState state = clock.state(now);
      ASSERT_NEAR(to_seconds(state.position), at, 1e-6);
      ASSERT_EQ(state.jumps, jumps);
      ASSERT_EQ(state.orders, static_cast<std::uint32_t>(i + 1));
      ASSERT_EQ(state.speed, speed);
      ASSERT_EQ(clock.state(now - step).position <= state.position, true) << "never back";
      at = to_seconds(state.position);
    }
  }
}

}  // namespace
}  // namespace handrail
