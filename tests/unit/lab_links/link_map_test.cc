// The map of links: what a clean, a far and a bad one give.
#include "server/lab/links/link_map.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

constexpr Nanos kDrive = 10 * kSecond;

TEST(LinkMap, ACleanLinkHasNoHoldAndFullSpeed) {
  const LinkFigures f = measure_link({}, kDrive);
  ASSERT_TRUE(f.engaged);
  EXPECT_NEAR(f.after, 1.0, 0.1) << "the second that it must have been heard";
  EXPECT_EQ(f.holds, 0.0);
  EXPECT_EQ(f.held, 0.0);
  EXPECT_EQ(f.ends, 0.0);
  EXPECT_GT(f.speed, 100.0);
  EXPECT_EQ(f.violations, 0u);
}

TEST(LinkMap, AFarLinkIsDrivenAndWhatItCostsIsCounted) {
  const LinkFigures clean = measure_link({}, kDrive);
  const LinkFigures far = measure_link({.delay_ms = 50, .jitter_ms = 20, .loss = 0.1}, kDrive);
  ASSERT_TRUE(far.engaged);
  EXPECT_LT(far.after, 1.5);
  EXPECT_GT(far.holds, 0.0);
  EXPECT_GT(far.held, 0.0);
  EXPECT_LT(far.held, 0.01);
  EXPECT_EQ(far.ends, 0.0);
  EXPECT_LT(far.speed, clean.speed);
  EXPECT_GT(far.speed, 0.5 * clean.speed);
  EXPECT_GT(far.behind, clean.behind);
  EXPECT_EQ(far.violations, 0u);
}

TEST(LinkMap, ABadLinkIsRefusedForAsLongAsIsTried) {
  const LinkFigures f = measure_link({.loss = 0.4}, kDrive);
  EXPECT_FALSE(f.engaged);
  EXPECT_EQ(f.speed, 0.0);
  EXPECT_EQ(f.violations, 0u);
}

TEST(LinkMap, TheTableHasARowForEachDelayAndJitterAndAColumnForEachLoss) {
  LinkMapOptions options;
  options.delays_ms = {0, 50};
  options.jitters_ms = {0, 20};
  options.losses = {0, 0.4};  // no row of 0 +- 20 ms
  options.drive = kSecond;
  options.threads = 1;
  const std::vector<LinkCell> cells = run_link_map(options);
  ASSERT_EQ(cells.size(), 6u);
  EXPECT_EQ(cells[3].link.delay_ms, 50.0);
  EXPECT_EQ(cells[3].link.jitter_ms, 0.0);
  EXPECT_EQ(cells[3].link.loss, 0.4);
  const std::string table = link_table(options, cells);
  EXPECT_NE(table.find("| delay +- jitter, ms | loss 0 % | loss 40 % |\n|---|---|---|\n| 0 +- 0 |"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find(" s, 100 %, none | refused |\n| 50 +- 0 |"), std::string::npos) << table;
  EXPECT_NE(
      link_json(cells).find("\"delay_ms\": 50, \"jitter_ms\": 0, \"loss\": 0.4, \"in_order\": "
                            "false, \"runs\": 1, \"engaged\": 0"),
      std::string::npos);
  // On two threads the same.
  options.threads = 2;
  EXPECT_EQ(link_json(run_link_map(options)), link_json(cells));
}

TEST(LinkMap, ALinkOnTheBrinkSaysHowManySeedsEngaged) {
  LinkMapOptions options;
  options.losses = {0.3};
  LinkCell cell{
      {},
      {.engaged = true, .after = 2.04, .holds = 20.0, .held = 0.004, .ends = 0.2, .speed = 500.0},
      5,
      2};
  EXPECT_NE(link_table(options, {cell}).find("2 of 5: 2.0 s, 100 %, 20 x 12 ms, 1 ends |"),
            std::string::npos)
      << link_table(options, {cell});
}

}  // namespace
}  // namespace handrail
