#include "server/base/plain_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handrail {
namespace {

using testing::ElementsAre;

TEST(PlainText, AcceptsUtf8OfEveryLength) {
  EXPECT_TRUE(is_plain_text("line\nand\ttab"));
  EXPECT_TRUE(is_plain_text("\u00e9 \u20ac \U0001F600"));
}

TEST(PlainText, RefusesMalformedOverlongAndSurrogateSequences) {
  for (const char* bad :
       {"\xff", "\xc3", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
        "\xf4\x90\x80\x80", "\x80", "\x1b[2J", "\x7f", "\xc2\x9b"}) {
    EXPECT_FALSE(is_plain_text(bad)) << static_cast<int>(static_cast<unsigned char>(bad[0]));
  }
}

TEST(Shown, IsOneLineOfPlainTextWhateverTheBytes) {
  EXPECT_EQ(shown("d\u00e9j\u00e0 vu"), "d\u00e9j\u00e0 vu");
  EXPECT_EQ(shown("a\nb\tc\x1b[2J\x7f"), "a?b?c?[2J?");
  EXPECT_EQ(shown("\xff|\xc3|\xc2\x9b|\xf0\x9f\x98"), "?|?|??|???");
}

TEST(Shown, LeavesOutTheMiddleOfALongTextBetweenTwoCharacters) {
  EXPECT_EQ(shown("0123456789", 10), "0123456789");
  EXPECT_EQ(shown("0123456789A", 10), "01234...6789A");
  EXPECT_EQ(shown("\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9", 10), "\u00e9\u00e9...\u00e9\u00e9");
  EXPECT_LT(shown(std::string(1 << 20, 'x')).size(), 70u);
}

TEST(NearestName, FindsWrongUnitsAndSlips) {
  const std::vector<std::string> names = {"method", "delta_mm", "stiffness_n_mm", "spring_n_mm"};
  EXPECT_EQ(nearest_name("stiffness_n_m", names), "stiffness_n_mm");
  EXPECT_EQ(nearest_name("stiffness", names), "stiffness_n_mm");
  EXPECT_EQ(nearest_name("metod", names), "method");
  EXPECT_EQ(nearest_name("delta_m", names), "delta_mm");
}

TEST(NearestName, GivesNoneWhenNothingIsNear) {
  EXPECT_EQ(nearest_name("zzzzzz", {"method", "delta_mm"}), "");
  EXPECT_EQ(nearest_name("", {"method"}), "");
}

TEST(Joined, PutsTheSeparatorBetween) {
  EXPECT_EQ(joined({"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(joined({"a"}, ", "), "a");
  EXPECT_EQ(joined({}, ", "), "");
}

TEST(PlaceAt, NamesTheMessagesAroundAByte) {
  const std::string text = "a: 1 # { not open\nb { c: \"}\" d [ { e: X ";
  const TextPlace place = place_at(text, text.size());
  EXPECT_THAT(place.open, ElementsAre("b", "d"));
  EXPECT_EQ(place.field, "e");
}

TEST(PlaceAt, ReturnsToTheOuterMessageAtABrace) {
  const std::string text = "b { c: 1 } f: [g, h] ";
  EXPECT_TRUE(place_at(text, text.size()).open.empty());
  EXPECT_EQ(place_at(text, text.size()).field, "f");
  EXPECT_THAT(place_at(text, 5).open, ElementsAre("b"));
}

}  // namespace
}  // namespace handrail
