// Somebody is asked for what the arm cannot do.
#include "client/experiment/standstill.h"

#include <gtest/gtest.h>

#include "client/experiment/live_status.h"
#include "client/experiment/recording/experiment_recording.h"

namespace handrail {
namespace {

TEST(Standstill, IsToldOnceAfterAMinuteOfTheSame) {
  Standstill it;
  EXPECT_EQ(it.see("to the start", "J6 ends", 5 * kSecond), "");
  EXPECT_EQ(it.see("to the start", "J6 ends", 64 * kSecond), "");
  EXPECT_EQ(it.see("to the start", "J6 ends", 65 * kSecond), "J6 ends");
  EXPECT_EQ(it.see("to the start", "J6 ends", 66 * kSecond), "");
  EXPECT_EQ(it.see("to the start", "J6 ends", 300 * kSecond), "");
}

TEST(Standstill, AnythingElseBeginsAnew) {
  Standstill it;
  EXPECT_EQ(it.see("to the start", "J6 ends", 0), "");
  EXPECT_EQ(it.see("at the start", "J6 ends", 50 * kSecond), "");
  EXPECT_EQ(it.see("at the start", "J6 ends", 100 * kSecond), "");
  EXPECT_EQ(it.see("at the start", "tip speed", 105 * kSecond), "");
  EXPECT_EQ(it.see("at the start", "tip speed", 160 * kSecond), "");
  EXPECT_EQ(it.see("at the start", "tip speed", 165 * kSecond), "tip speed");
}

// A person may take their time while nothing holds the arm.
TEST(Standstill, WhereNothingHoldsTheArmNothingIsTold) {
  Standstill it;
  for (int s = 0; s < 600; ++s) EXPECT_EQ(it.see("mark", "none", s * kSecond), "");
}

TEST(Standstill, OnlyAnArmThatIsLedIsHeld) {
  pb::Status now;
  now.set_reason("J6 ends");
  for (const char* state : {"off", "clutched", "fault"}) {
    now.set_state(state);
    EXPECT_EQ(holds(now), "none") << state;
  }
  now.set_state("engaged");
  EXPECT_EQ(holds(now), "J6 ends");
}

TEST(RecordingOfARunner, IsTheOneWithItsWholeLabel) {
  const std::string file = "/r/20261128T073324.964Z-master-gearshift-ann.mcap";
  EXPECT_TRUE(is_recording_with("gearshift-ann", file));
  EXPECT_FALSE(is_recording_with("gearshift-anna", file));
  EXPECT_FALSE(is_recording_with("gearshift-an", file));
  EXPECT_FALSE(is_recording_with("ann", file));
  EXPECT_FALSE(is_recording_with("gearshift-ann", ""));
  EXPECT_EQ(recording_label("linear-movement", "a.b_c"), "linear-movement-a-b_c");
  EXPECT_EQ(recording_label("wrench-loosening", std::string(32, 'x')).size(), 40u);
}

}  // namespace
}  // namespace handrail
