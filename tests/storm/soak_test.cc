#include "tests/storm/soak.h"

#include <gmock/gmock.h>

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;

SoakOutcome with_growth(double rig, double slave, double master) {
  SoakOutcome out;
  out.complete = true;
  out.minutes = 10.0;
  const double rates[] = {rig, slave, master};
  for (std::size_t i = 0; i < out.growth.size(); ++i) out.growth[i].slope.value = rates[i];
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
