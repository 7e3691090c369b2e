// Efficient settings, sums of errors, and the table's text.
#include "server/lab/scenes/row.h"

#include <gmock/gmock.h>

#include "server/base/random.h"
#include "server/lab/scenes/drawing.h"
#include "server/lab/scenes/report_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AccuracyRow row(const std::string& choice, double error, double cost) {
  AccuracyRow out;
  out.choice = choice;
  out.method = "m";
  out.setting = "s";
  out.error = {"um", error, 2.0 * error};
  out.cost = {"ns", cost, 3.0 * cost};
  out.memory_bytes = 40;
  return out;
}

TEST(ErrorSum, IsTheRootMeanSquareAndTheLargestSize) {
  ErrorSum sum;
  EXPECT_EQ(sum.rms(), 0.0);
  sum.add(3.0);
  sum.add(-4.0);
  EXPECT_DOUBLE_EQ(sum.rms(), std::sqrt(12.5));
  EXPECT_EQ(sum.worst(), 4.0);
  EXPECT_EQ(sum.in("um", 1e6).worst, 4e6);
}

TEST(EfficientRows, AreThoseNoOtherOfTheirChoiceBeats) {
  const AccuracyRows rows = {row("a", 1.0, 9.0), row("a", 2.0, 5.0), row("a", 3.0, 5.0),
                             row("a", 2.5, 7.0), row("a", 9.0, 1.0), row("b", 99.0, 99.0)};
  EXPECT_THAT(efficient(rows), ElementsAre(true, true, false, false, true, true));
}

TEST(EfficientRows, KeepEquals) {
  EXPECT_THAT(efficient({row("a", 1.0, 1.0), row("a", 1.0, 1.0)}), ElementsAre(true, true));
}

TEST(EfficientRows, CompeteOnlyWithThoseThatNeedTheSame) {
  AccuracyRows rows = {row("a", 1.0, 1.0), row("a", 2.0, 2.0)};
  rows[0].needs = "drawn walls";
  EXPECT_THAT(efficient(rows), ElementsAre(true, true));
}

TEST(EfficientRows, AreNeverDominatedAndDominateTheRest) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    AccuracyRows rows;
    for (int i = 0; i < 20; ++i) {
      rows.push_back(
          row("a", std::floor(8.0 * random.uniform()), std::floor(8.0 * random.uniform())));
    }
    const std::vector<bool> best = efficient(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      bool beaten = false;
      for (const AccuracyRow& other : rows) {
        beaten |=
            (other.error.rms < rows[i].error.rms && other.cost.median <= rows[i].cost.median) ||
            (other.error.rms <= rows[i].error.rms && other.cost.median < rows[i].cost.median);
      }
      ASSERT_EQ(best[i], !beaten);
    }
  }
}

TEST(AccuracyReport, HasAHeadingForEachChoiceAndStarsTheEfficient) {
  const std::string text =
      accuracy_table({row("a", 1.0, 9.0), row("a", 2.0, 10.0), row("b", 1, 1)});
  EXPECT_THAT(text, HasSubstr("\n* m                 s  "));
  EXPECT_THAT(text, HasSubstr("\n  m                 s  "));
  EXPECT_THAT(text, HasSubstr("\nb  "));
  EXPECT_THAT(text, HasSubstr("error [um]"));
  EXPECT_THAT(text, HasSubstr("cost [ns]"));
}

TEST(AccuracyReport, WritesEveryFieldAsJson) {
  AccuracyRow one = row("wall", 0.0, 9.5);
  const std::string bare = accuracy_json({one});
  for (const char* part : {"\"rows\"", "\"choice\"", "\"wall\"", "\"method\"", "\"setting\"",
                           "\"error\"", "\"unit\"", "\"rms\"", "\"worst\"", "\"cost\"",
                           "\"median\"", "\"p999\"", "\"memory_bytes\"", "9.5", "28.5", "40"}) {
    EXPECT_THAT(bare, HasSubstr(part));
  }
  EXPECT_THAT(bare, ::testing::Not(HasSubstr("note")));
  one.note = "stays behind";
  EXPECT_THAT(accuracy_json({one}), HasSubstr("stays behind"));
}

TEST(AccuracyFigures, AreOneFileAChoice) {
  const TempFolder folder;
  const std::string where = folder.path() + "/new";
  ASSERT_TRUE(
      draw_accuracy(where, {row("wall", 1.0, 9.0), row("wall", 0.0, 20.0), row("b", 1, 1)}));
  std::stringstream svg;
  svg << std::ifstream(where + "/accuracy-wall.svg").rdbuf();
  EXPECT_THAT(svg.str(), HasSubstr("s: no error"));
  EXPECT_TRUE(std::ifstream(where + "/accuracy-b.svg").good());
  EXPECT_FALSE(draw_accuracy("/proc/nowhere", {row("wall", 1.0, 9.0)}));
}

}  // namespace
}  // namespace handrail
