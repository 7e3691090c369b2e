#include "server/link/session_watch.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(SessionWatch, EveryChangeIsALineWithItsReason) {
  SessionWatch watch;
  const auto why = [](Reason reason) { return reason == Reason::kPeerFault ? "theirs" : "ours"; };
  EXPECT_EQ(watch.step(0, SessionState::kOff, Reason::kNoPeer, why), std::nullopt);
  EXPECT_EQ(watch.step(1, SessionState::kEngaged, Reason::kNone, why), "session engaged");
  EXPECT_EQ(watch.step(2, SessionState::kEngaged, Reason::kBumper, why), std::nullopt);
  EXPECT_EQ(watch.step(3, SessionState::kFault, Reason::kPeerFault, why), "session fault: theirs");
  EXPECT_EQ(watch.step(4, SessionState::kFault, Reason::kPeerFault, why), std::nullopt);
  EXPECT_EQ(watch.step(5, SessionState::kFault, Reason::kRobotLost, why), "session fault: ours");
  EXPECT_EQ(watch.step(6, SessionState::kOff, Reason::kNone, why), "session off");
}

TEST(SessionWatch, HoldsThatComeAndGoAreALineASecondAndNothingElseWaits) {
  SessionWatch watch;
  int lines = 0;
  const auto step = [&](Nanos now, SessionState state) {
    auto line = watch.step(now, state, Reason::kNone, [](Reason) { return ""; });
    lines += line.has_value();
    return line;
  };
  EXPECT_TRUE(step(0, SessionState::kEngaged));
  lines = 0;
  for (int i = 1; i <= 10'000; ++i) {
    step(i * kMillisecond, i % 2 == 0 ? SessionState::kEngaged : SessionState::kHold);
  }
  EXPECT_GE(lines, 9);
  EXPECT_LE(lines, 11);
  EXPECT_EQ(step(10'001 * kMillisecond, SessionState::kFault), "session fault");
  EXPECT_EQ(step(10'002 * kMillisecond, SessionState::kOff), "session off");
  EXPECT_EQ(step(10'003 * kMillisecond, SessionState::kEngaged), "session engaged");
}

}  // namespace
}  // namespace handrail
