// Whole figures as files.
#include "server/lab/figure/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "tests/support/temp_folder.h"
#include "tests/unit/lab_figure/svg_shapes.h"

namespace handrail::figure {
namespace {

using testing::HasSubstr;
using testing::Not;

// Two panels that share a series, with hostile texts and values.
Figure sample() {
  const double failed = std::numeric_limits<double>::infinity();
  Figure figure("A & B <1>", "simulated operators \"x\"");
  Panel lines("first", {.label = "t [s]"}, {.label = "f < g [N]", .scale = Scale::kLog});
  lines.line({{0, 1}, {1, 1e9}, {2, failed}, {3, 1e-9}}, style_of(1), "shared");
  lines.reference(10, "limit & more");
  Panel boxes("second", {}, {.label = "error [mm]"});
  boxes.points({{1, 2}, {2, 3}}, style_of(1), "shared");
  boxes.points({{1, 2}}, style_of(2));
  boxes.box({.values = {1, 2, failed, failed}, .name = "only here"});
  boxes.note({1, 2}, "<note>");
  figure.add(lines);
  figure.add(boxes);
  return figure;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Figure, IsWellFormedSvgWithoutNaN) {
  const std::string svg = sample().svg();
  EXPECT_TRUE(well_formed(svg));
  EXPECT_THAT(svg, HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\""));
  EXPECT_THAT(svg, HasSubstr("<title>A &amp; B &lt;1&gt;</title>"));
  EXPECT_THAT(svg, HasSubstr("simulated operators &quot;x&quot;"));
  EXPECT_THAT(svg, HasSubstr("&lt;note&gt;"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(Figure, NamesASeriesOnceHoweverManyPanelsShowIt) {
  const std::string svg = sample().svg();
  EXPECT_EQ(count(svg, ">shared<"), 1u);
  EXPECT_EQ(count(svg, ">only here<"), 1u);
}

TEST(Figure, IsTheSameTextForTheSameContents) { EXPECT_EQ(sample().svg(), sample().svg()); }

TEST(Figure, PutsPanelsInRowsWithAlignedFrames) {
  Figure figure("grid", "", {.columns = 2});
  for (const std::string label : {"a", "1", "b", "2"}) {
    Panel panel("", {.label = label}, {.label = label});
    panel.points({{0, 0}, {1, label < "a" ? 123456.0 : 1.0}}, style_of(0));
    figure.add(panel);
  }
  std::vector<std::string> frames;
  for (const std::string& line : elements(figure.svg(), "polyline")) {
    frames.push_back(attribute(line, "points"));
  }
  ASSERT_EQ(frames.size(), 4u);
  const auto left = [&](std::size_t i) { return frames[i].substr(0, frames[i].find(',')); };
  const auto top = [&](std::size_t i) {
    const std::size_t comma = frames[i].find(',');
    return frames[i].substr(comma, frames[i].find(' ') - comma);
  };
  EXPECT_EQ(left(0), left(2));
  EXPECT_EQ(left(1), left(3));
  EXPECT_GT(std::stod(left(0)), 12.0 + 30.0) << "room for labels beside the first column";
  EXPECT_GT(std::stod(left(1)), 12.0 + 340.0 + 10.0 + 30.0) << "and the second";
  EXPECT_EQ(top(0), top(1));
  EXPECT_EQ(top(2), top(3));
  // Corners: upper left, upper right, lower right, lower left, upper left.
  const std::string lower_right = frames[0].substr(0, frames[0].rfind(' '));
  const double bottom = std::stod(lower_right.substr(lower_right.rfind(',') + 1));
  EXPECT_GT(std::stod(top(2).substr(1)), bottom + 50.0) << "room for labels and a title between";
}

TEST(Figure, KeepsEverythingOnThePage) {
  const std::string svg = sample().svg();
  const std::string page = elements(svg, "svg")[0];
  for (const std::string& text : elements(svg, "text")) {
    EXPECT_GE(value(text, "x"), 0.0) << text;
    EXPECT_LE(value(text, "x"), value(page, "width")) << text;
    EXPECT_GE(value(text, "y"), 0.0) << text;
    EXPECT_LE(value(text, "y"), value(page, "height")) << text;
  }
}

TEST(Figure, WithoutPanelsIsStillAPage) { EXPECT_TRUE(well_formed(Figure("none", "").svg())); }

TEST(Figure, WritesItsTextToTheFile) {
  const TempFolder folder;
  const std::string path = folder.write("figure.svg", std::string(1000000, 'x'));
  ASSERT_TRUE(sample().write_file(path));
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  EXPECT_EQ(text.str(), sample().svg());
}

TEST(Figure, ErrorsNameThePathAndTheReason) {
  const TempFolder folder;
  const std::string path = folder.path() + "/missing/figure.svg";
  const Status status = sample().write_file(path);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.message(), HasSubstr(path));
  EXPECT_THAT(status.message(), HasSubstr("No such file or directory"));
}

TEST(Figure, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  const Status status = sample().write_file("/dev/full");
  ASSERT_FALSE(status);
  EXPECT_THAT(status.message(), HasSubstr("/dev/full: "));
  EXPECT_THAT(status.message(), HasSubstr("No space left"));
}

}  // namespace
}  // namespace handrail::figure
