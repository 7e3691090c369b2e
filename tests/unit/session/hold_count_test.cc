#include "server/session/hold_count.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

constexpr Nanos kStep = kMillisecond;

TEST(HoldCount, CountsHowOftenHowLongAndTheLongest) {
  HoldCount count;
  const auto step = [&count](int steps, SessionState state, Reason reason) {
    for (int i = 0; i < steps; ++i) count.step(kStep, state, reason);
  };
  step(5, SessionState::kEngaged, Reason::kNone);
  step(3, SessionState::kHold, Reason::kNone);
  step(2, SessionState::kEngaged, Reason::kBumper);
  step(4, SessionState::kHold, Reason::kLinkHold);
  step(4, SessionState::kEngaged, Reason::kLinkHold);  // the same one
  step(1, SessionState::kEngaged, Reason::kNone);
  EXPECT_EQ(count.times(), 2);
  EXPECT_EQ(count.held(), 11 * kStep);
  EXPECT_EQ(count.longest(), 8 * kStep);
}

TEST(HoldCount, AnArmThatWaitsForItsMasterOrIsNotEngagedHoldsForNoLink) {
  HoldCount count;
  count.step(kStep, SessionState::kOff, Reason::kLinkHold);
  count.step(kStep, SessionState::kEngaged, Reason::kNotEngaged);
  count.step(kStep, SessionState::kEngaged, Reason::kLinkHold);
  EXPECT_EQ(count.times(), 0);
  count.step(kStep, SessionState::kEngaged, Reason::kNone);
  count.step(kStep, SessionState::kFault, Reason::kLinkHold);
  count.step(kStep, SessionState::kEngaged, Reason::kLinkHold);
  EXPECT_EQ(count.times(), 0);
}

}  // namespace
}  // namespace handrail
