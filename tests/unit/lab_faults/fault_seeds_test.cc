// Seeds as words on the command line.
#include "server/lab/faults/fault_seeds.h"

#include <gmock/gmock.h>

#include "server/lab/faults/fault_command.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(FaultSeedsTest, ASeedARangeAndBoth) {
  EXPECT_THAT(parse_seeds("7").value(), ElementsAre(7u));
  EXPECT_THAT(parse_seeds("3..6").value(), ElementsAre(3u, 4u, 5u, 6u));
  EXPECT_THAT(parse_seeds("5..5").value(), ElementsAre(5u));
  EXPECT_THAT(parse_seeds("2024,3..5,4").value(), ElementsAre(3u, 4u, 5u, 2024u));
  EXPECT_EQ(parse_seeds("1..1000").value().size(), kMostSeeds);
  EXPECT_THAT(parse_seeds("18446744073709551614..18446744073709551615").value(),
              ElementsAre(18446744073709551614u, 18446744073709551615u));
}

TEST(FaultSeedsTest, WhatNamesNoSeedsIsRefusedWithWhatWasExpected) {
  const struct {
    const char* text;
    const char* says;
  } cases[] = {{"5..1", "5 is after 1; expected a range that rises"},
               {"a..b", "'a..b' is no seed and no range; expected such as 7 or 1..50"},
               {"", "'' is no seed"},
               {"1,,2", "'' is no seed"},
               {"1,", "'' is no seed"},
               {"-1", "'-1' is no seed"},
               {"1.5", "'1.5' is no seed"},
               {"1..2..3", "'1..2..3' is no seed"},
               {" 1", "' 1' is no seed"},
               {"18446744073709551616", "is no seed"},
               {"1..1001", "too many; expected at most 1000"},
               {"1..600,1001..1401", "too many"},
               {"0..18446744073709551615", "too many"}};
  for (const auto& c : cases) {
    const auto seeds = parse_seeds(c.text);
    ASSERT_FALSE(seeds.is_ok()) << c.text;
    EXPECT_THAT(seeds.message(), HasSubstr(c.says)) << c.text;
    EXPECT_THAT(seeds.message(), HasSubstr(std::string("seeds '") + c.text + "'"));
    FaultCommand command;
    command.seeds = c.text;
    EXPECT_EQ(run_fault_command(command, false), 2) << c.text;
  }
}

}  // namespace
}  // namespace handrail
