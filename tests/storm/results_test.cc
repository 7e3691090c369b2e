#include "tests/storm/results.h"

#include <gmock/gmock.h>

#include <sstream>

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;

Line some(std::uint64_t seed, bool ok) {
  Outcome outcome;
  outcome.start = 5 * kSecond;
  outcome.seconds = 7.25;
  outcome.figures = {700, ok ? 0u : 2u, 0.5, ok ? 0.9 : 19.0, 0.97, 4, 0, 1, 7.0};
  if (!ok) outcome.violations = {{6 * kSecond, "J1\tfar\nout"}, {7 * kSecond, "more"}};
  return line_of(draw(seed), outcome);
}

TEST(StormResults, ALineIsReadBackAsItWasWritten) {
  for (const bool ok : {true, false}) {
    const Line line = some(42, ok);
    const auto read = from_line(to_line(line));
    ASSERT_TRUE(read) << read.message();
    EXPECT_EQ(to_line(*read), to_line(line));
    EXPECT_EQ(read->ok, ok);
    EXPECT_EQ(read->done, text(draw(42)));
  }
  EXPECT_THAT(to_line(some(42, false)), HasSubstr("1.000 s: J1 far out | 2.000 s: more"));
}

TEST(StormResults, AnInterruptedStormGoesOnAfterItsLastWholeLine) {
  TempFolder folder;
  const std::string path = folder.write(
      "storm.tsv", to_line(some(7, true)) + "\n" + to_line(some(8, false)) + "\n9\tok");
  {
    Results results;
    ASSERT_TRUE(results.open(path));
    EXPECT_TRUE(results.has(7));
    EXPECT_FALSE(results.of(8).ok);
    EXPECT_FALSE(results.has(9));
    EXPECT_TRUE(results.add(some(9, true)));
  }
  Results again;
  ASSERT_TRUE(again.open(path));
  EXPECT_TRUE(again.has(9));
  EXPECT_EQ(again.of(9).figures.targets, 700u);
}

TEST(StormResults, NamesALineThatIsNone) {
  TempFolder folder;
  const std::string path = folder.write("storm.tsv", to_line(some(7, true)) + "\nmine\n");
  Results results;
  EXPECT_EQ(results.open(path).message(), path + ":2: 1 columns, expected 14");
  EXPECT_THAT(Results().open(folder.path() + "/none/storm.tsv").message(),
              HasSubstr("No such file"));
  EXPECT_FALSE(from_line(to_line(some(7, true)).insert(0, 1, 'x')));
}

TEST(StormResults, TheSummaryNamesTheSeedsThatWereViolated) {
  Summary all;
  all.add(some(7, true));
  EXPECT_THAT(for_people(all), HasSubstr("fewer than 100.0 %"));
  all.add(some(8, false));
  all.add(some(9, true));
  EXPECT_THAT(for_people(all), HasSubstr("1 of 3 sequences violated; of 2100 targets 2 beyond"));
  EXPECT_THAT(for_people(all), HasSubstr("violated at seeds 8\n"));
  EXPECT_EQ(
      to_json(all),
      "{\"sequences\": 3, \"violated\": 1, \"seeds_with_violations\": [8], \"targets\": 2100, "
      "\"beyond_a_limit\": 2, \"step\": 0.5, \"acceleration\": 19, \"jerk\": 0.97, "
      "\"held_cycles\": 12, \"late_cycles\": 0, \"halts\": 3, \"hardest_halt\": 7}\n");
  // Rule of three.
  Summary green;
  for (std::uint64_t seed = 0; seed < 300; ++seed) green.add(some(seed, true));
  EXPECT_DOUBLE_EQ(green.bound(), 0.01);
}

}  // namespace
}  // namespace handrail::storm
