#include "tests/storm/soak.h"

#include <gmock/gmock.h>

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;

SoakOutcome with_growth(double rig, double slave, double master) {
  SoakOutcome out;
  out.complete = true;
  out.minutes = 10.0;
  out.growth[0].slope.value = rig;
  out.growth[1].slope.value = slave;
  out.growth[2].slope.value = master;
  return out;
}

TEST(Soak, OneProgramThatGrowsIsEnough) {
  EXPECT_FALSE(grows(with_growth(1.0, 0.0, -3.0)));
  for (const auto& one :
       {with_growth(1.01, 0.0, 0.0), with_growth(0.0, 1.01, 0.0), with_growth(0.0, 0.0, 1.01)}) {
    EXPECT_TRUE(grows(one));
    EXPECT_THAT(for_people(one), HasSubstr("GROWS"));
  }
}

TEST(Soak, TheWorstIsNamed) {
  EXPECT_THAT(for_people(with_growth(0.1, 0.4, 0.2)),
              HasSubstr("worst: slave, 0.400 MiB an hour over 10.0 min"));
}

}  // namespace
}  // namespace handrail::storm
