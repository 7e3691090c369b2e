// What RESULTS.md quotes from the dissertation is what the program holds.
#include <spdlog/fmt/fmt.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "server/lab/study/linear/linear_figure.h"
#include "server/lab/study/screw/screw_figure.h"

namespace handrail {
namespace {

// The cells of the row of `count` cells that begins with `title`, that one left out: the two
// studies have rows of the same title.
std::vector<std::string> row(const std::string& title, std::size_t count) {
  std::ifstream page(std::string(HANDRAIL_SOURCE_DIR) + "/server/lab/RESULTS.md");
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| " + title + " ")) continue;
    std::vector<std::string> cells;
    for (std::size_t from = line.find('|', 1) + 1, to = 0;
         (to = line.find('|', from)) != std::string::npos; from = to + 1) {
      cells.push_back(line.substr(from + 1, to - from - 2));
    }
    if (cells.size() == count) return cells;
  }
  ADD_FAILURE() << "the page has no row '" << title << "'";
  return std::vector<std::string>(count);
}

// "-43.4 %" of a ratio of 0.566.
double lowered(ScrewPairing pairing, ScrewFigure figure) {
  return 100.0 * (implied_ratio(pairing, figure) - 1.0);
}

TEST(PublishedFigures, OfTheLinearMovementAreThoseThePageQuotes) {
  for (int i = 0; i < kPublishedFigures; ++i) {
    const LinearFigureInfo& info = info_of(static_cast<LinearFigure>(i));
    const auto cells = row(fmt::format("{}, {}", info.title, info.unit), 5);
    EXPECT_EQ(cells.back(),
              fmt::format("{}, {}", info.published[static_cast<int>(StudyMode::kFree)],
                          info.published[static_cast<int>(StudyMode::kTools)]))
        << info.title;
  }
}

TEST(PublishedFigures, OfTheScrewAreThoseThePageQuotes) {
  for (int i = 0; i < kImpliedFigures; ++i) {
    const ScrewFigureInfo& info = info_of(static_cast<ScrewFigure>(i));
    const auto cells = row(fmt::format("{}, {}", info.title, info.unit), 4);
    for (std::size_t mode = 0; mode < cells.size(); ++mode) {
      // Paths are told in whole millimetres.
      const double told =
          info.implied[mode] > 100.0 ? std::floor(info.implied[mode] + 0.5) : info.implied[mode];
      const std::string end = fmt::format("], {}", told);
      EXPECT_TRUE(cells[mode].ends_with(end) ||
                  cells[mode].ends_with(fmt::format("], {:.1f}", told)))
          << info.title << ": '" << cells[mode] << "' does not end with '" << end << "'";
    }
  }
}

TEST(PublishedFigures, SavingsOfTheScrewAreThoseThePageQuotes) {
  const auto quoted = [](ScrewPairing first, ScrewPairing second, ScrewFigure figure) {
    return fmt::format("{:.1f}, {:.1f} %", lowered(first, figure), lowered(second, figure));
  };
  EXPECT_EQ(
      row("protection: mean contact force", 3).back(),
      quoted(ScrewPairing::kProtectionNV, ScrewPairing::kProtectionV, ScrewFigure::kMeanForce));
  EXPECT_EQ(row("tools: path of the tip", 3).back(),
            quoted(ScrewPairing::kToolsNC, ScrewPairing::kToolsC, ScrewFigure::kPath));
  EXPECT_EQ(row("tools: completion time", 3).back(),
            quoted(ScrewPairing::kToolsNC, ScrewPairing::kToolsC, ScrewFigure::kTime));
}

}  // namespace
}  // namespace handrail
