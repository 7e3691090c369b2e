// The strip below a preview: its scale, its entries, its letters.
#include "server/lab/scenes/legend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/lab/scenes/letters.h"
#include "server/lab/scenes/preview.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr Colour kGround = {255, 255, 255}, kRed = {200, 0, 0};

int count(const Canvas& canvas, const Colour& colour, int from_row = 0) {
  int out = 0;
  for (int y = from_row; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) out += canvas.at(x, y) == colour;
  }
  return out;
}

// The longest run of dark pixels in a row.
int longest_bar(const Canvas& canvas) {
  int longest = 0;
  for (int y = 0; y < canvas.height(); ++y) {
    int run = 0;
    for (int x = 0; x < canvas.width(); ++x) {
      run = canvas.at(x, y)[0] < 100 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

TEST(Legend, TheBarIsARoundNumberOfMillimetresAtMostAQuarterOfTheWidth) {
  struct Case {
    double per_mm, bar_mm;
  };
  for (const Case& c : {Case{10.0, 20.0}, Case{13.9, 10.0}, Case{100.0, 2.0}, Case{1.2, 200.0},
                        Case{600.0, 0.2}, Case{40.0, 5.0}}) {
    const Legend legend(1000.0, 1e3 * c.per_mm);
    Canvas canvas(1000, legend.height(), kGround);
    legend.draw(canvas, 0);
    EXPECT_NEAR(longest_bar(canvas), c.bar_mm * c.per_mm, 3.0) << c.per_mm;
  }
}

TEST(Legend, AnEntryIsDrawnAsInThePictureAndAFullLineGoesOnInTheNext) {
  Legend legend(1000.0, 1e4);
  const int empty = legend.height();
  legend.add({LegendEntry::Mark::kLine, kRed, 3.0, "a line"});
  EXPECT_EQ(legend.height(), empty);
  for (int i = 0; i < 8; ++i) legend.add({LegendEntry::Mark::kNone, {}, 0.0, "as wide as a dozen"});
  EXPECT_GT(legend.height(), empty);
  Canvas canvas(1000, 40 + legend.height(), kGround);
  legend.draw(canvas, 40);
  EXPECT_GT(count(canvas, kRed), 60);
  EXPECT_EQ(count(canvas, kGround) - count(canvas, kGround, 40), 40 * 1000);  // nothing above
}

TEST(Letters, AreAsWideAsTheirWidthSaysAndUnlikeEachOther) {
  std::vector<int> inks;
  for (const char* word : {"12.5 mm", "a hand that wanders", "\xC3\xA4"}) {
    Canvas canvas(300, 30, kGround);
    draw_letters(canvas, {10.0, 20.0}, word, 9.0, kRed);
    int last = 0, ink = 0;
    for (int x = 0; x < canvas.width(); ++x) {
      for (int y = 0; y < canvas.height(); ++y) {
        if (canvas.at(x, y) != kGround) last = x, ++ink;
      }
    }
    EXPECT_NEAR(last, 10.0 + letters_width(word, 9.0), 1.5) << word;
    inks.push_back(ink);
  }
  EXPECT_GT(inks[1], inks[0]);
  EXPECT_GT(inks[2], 0);  // what is not ASCII is a box
  EXPECT_EQ(letters_width("", 9.0), 0.0);
}

TEST(ScenePreview, ACrossSaysWhereAnArrowIsLeftOut) {
  const auto scene = SceneLibrary().load("painted-aisle");
  ASSERT_TRUE(scene) << scene.message();
  const auto canvas = preview_scene(*scene);
  ASSERT_TRUE(canvas) << canvas.message();
  // The grid's first place is deep in the wall, and one of the last rows too.
  const double half = 0.5 * kPreviewSide / 32.0;
  for (const double at : {half, kPreviewSide - half}) {
    const int x = static_cast<int>(half), y = static_cast<int>(at);
    EXPECT_LT(canvas->at(x, y)[0], 100) << at;
    EXPECT_EQ(canvas->at(x + 6, y), canvas->at(x + 6, y + 6));  // and no arrow
  }
  EXPECT_GT(count(*canvas, kForceColour, kPreviewSide), 20);  // said below
}

}  // namespace
}  // namespace handrail
