// Somebody is asked for what the arm cannot do.
#include "client/experiment/standstill.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace handrail
