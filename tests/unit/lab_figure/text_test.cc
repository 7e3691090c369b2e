// Numbers and text as SVG wants them.
#include "server/lab/figure/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/lab/figure/label_placer.h"
#include "server/lab/figure/style.h"

namespace handrail::figure {
namespace {

using testing::ElementsAre;

TEST(Number, HasAtMostTwoDecimals) {
  EXPECT_EQ(number(0), "0");
  EXPECT_EQ(number(-0.001), "0");
  EXPECT_EQ(number(12.5), "12.5");
  EXPECT_EQ(number(100), "100");
  EXPECT_EQ(number(-3.14159), "-3.14");
  EXPECT_EQ(number(1e20), "100000000000000000000");
}

TEST(Escape, TurnsMarkupIntoText) {
  EXPECT_EQ(escape("a < b & c > \"d\" 'e'"), "a &lt; b &amp; c &gt; &quot;d&quot; &apos;e&apos;");
}

TEST(Escape, KeepsUtf8) {
  for (const std::string text : {"10⁻⁶ µm", "日本", "\U0001F600", "tab\tand\nline"}) {
    EXPECT_EQ(escape(text), text);
  }
}

TEST(Escape, ReplacesWhatXmlDoesNotAllow) {
  const std::string mark = "\xEF\xBF\xBD";
  EXPECT_EQ(escape(std::string("a\0b", 3)), "a" + mark + "b");
  EXPECT_EQ(escape("\x1b["), mark + "[");
  EXPECT_EQ(escape("\xff"), mark);
  EXPECT_EQ(escape("cut \xE2\x82"), "cut " + mark + mark) << "a character cut short";
  EXPECT_EQ(escape("\xC0\xAF"), mark + mark) << "longer than need be";
  EXPECT_EQ(escape("\xE0\x80\xAF"), mark + mark + mark) << "longer than need be";
  EXPECT_EQ(escape("\xED\xA0\x80"), mark + mark + mark) << "a surrogate";
  EXPECT_EQ(escape("\xF4\x90\x80\x80"), mark + mark + mark + mark) << "past the last character";
  EXPECT_EQ(escape("\xEF\xBF\xBF"), mark + mark + mark) << "no character";
}

TEST(TextWidth, GrowsWithTextAndSizeAndCountsCharactersNotBytes) {
  EXPECT_EQ(text_width("", 10), 0.0);
  EXPECT_NEAR(text_width("1234567890", 10), 58.0, 8.0);  // Helvetica's digits: 0.556
  EXPECT_LT(text_width("iii", 10), text_width("mmm", 10));
  EXPECT_DOUBLE_EQ(text_width("µ", 20), 2 * text_width("µ", 10));
  EXPECT_DOUBLE_EQ(text_width("⁻⁶", 10), 2 * text_width("µ", 10));
}

TEST(Wrap, BreaksAtSpacesOnly) {
  EXPECT_THAT(wrap("one two three", 10, 1000), ElementsAre("one two three"));
  EXPECT_THAT(wrap("one two three", 10, text_width("one two", 10) + 0.01),
              ElementsAre("one two", "three"));
  EXPECT_THAT(wrap("one two three", 10, 0), ElementsAre("one", "two", "three"));
  EXPECT_THAT(wrap("", 10, 100), ElementsAre(""));
  EXPECT_THAT(wrap("one two\nthree", 10, 1000), ElementsAre("one two", "three"));
}

// CIE L* of "#rrggbb". Source: IEC 61966-2-1 and CIE 15.
double lightness(std::string_view colour) {
  const auto linear = [&](std::size_t at) {
    const double c = std::stoi(std::string(colour.substr(at, 2)), nullptr, 16) / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double y = 0.2126 * linear(1) + 0.7152 * linear(3) + 0.0722 * linear(5);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(Colours, DifferInLightnessFromEachOtherAndFromPaper) {
  std::vector<double> found = {lightness("#ffffff")};
  for (const std::string_view colour : kColours) found.push_back(lightness(colour));
  std::sort(found.begin(), found.end());
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_GE(found[i] - found[i - 1], 9.0) << i;
}

TEST(StyleOf, DiffersInEveryWayAmongTheFirstFive) {
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_NE(style_of(i).colour, style_of(k).colour);
      EXPECT_NE(style_of(i).dash, style_of(k).dash);
      EXPECT_NE(style_of(i).marker, style_of(k).marker);
    }
  }
  EXPECT_EQ(style_of(7).colour, style_of(2).colour);
}

bool apart(const Rect& a, const Rect& b) {
  return a.right() <= b.left || b.right() <= a.left || a.bottom() <= b.top || b.bottom() <= a.top;
}

TEST(LabelPlacer, PutsLabelsOfOnePointBesideEachOther) {
  LabelPlacer placer({0, 0, 200, 200});
  placer.take({96, 96, 8, 8});
  std::vector<Rect> placed = {{96, 96, 8, 8}};
  for (int i = 0; i < 4; ++i) {
    const Rect next = placer.place_beside({100, 100}, 30, 12, 6);
    for (const Rect& other : placed) EXPECT_TRUE(apart(next, other)) << i;
    placed.push_back(next);
  }
}

TEST(LabelPlacer, CoversALineRatherThanAMark) {
  LabelPlacer placer({0, 0, 200, 200});
  placer.take({0, 0, 200, 200});
  placer.take_mark({130, 90, 4, 20});  // the label to the right would reach it
  EXPECT_EQ(placer.place_beside({100, 100}, 40, 12, 6).right(), 94);
}

TEST(LabelPlacer, FindsRoomInACrowdOfMarksAndAWayToItPastThem) {
  LabelPlacer placer({0, 0, 300, 200});
  std::vector<Point> at;
  for (int i = 0; i < 6; ++i) at.push_back({5.0 + 6.0 * i, 100.0 + 9.0 * i});
  std::vector<Rect> taken;
  for (const Point& p : at) taken.push_back({p.x - 4.0, p.y - 4.0, 8.0, 8.0});
  for (const Rect& mark : taken) placer.take_mark(mark);
  for (const Point& p : at) {
    const Rect label = placer.place_beside(p, 60, 12, 6);
    for (const Rect& other : taken) EXPECT_TRUE(apart(label, other)) << p.x << ' ' << other.left;
    const Point end = nearest_of(label, p);
    for (const Point& mark : at) {
      for (int i = 0; i <= 20 && !(mark == p); ++i) {
        const double x = std::lerp(p.x, end.x, i / 20.0), y = std::lerp(p.y, end.y, i / 20.0);
        EXPECT_GT(std::hypot(x - mark.x, y - mark.y), 3.0) << p.x << ' ' << mark.x;
      }
    }
    taken.push_back(label);
  }
}

TEST(LabelPlacer, PrefersTheRightAndStaysInTheFrame) {
  LabelPlacer placer({0, 0, 200, 100});
  const Rect right = placer.place_beside({50, 50}, 30, 12, 6);
  EXPECT_EQ(right.left, 56);
  EXPECT_EQ(right.center_y(), 50);
  placer.take({190, 40, 10, 20});
  const Rect left = placer.place_beside({195, 50}, 30, 12, 6);
  EXPECT_EQ(left.right(), 189);
  const Rect corner = placer.place({{500, -40, 30, 12}});
  EXPECT_EQ(corner.right(), 200);
  EXPECT_EQ(corner.top, 0);
}

}  // namespace
}  // namespace handrail::figure
