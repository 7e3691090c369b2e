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
  for (const char* bad : {"\xff", "\xc3", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80",
                          "\xf0\x80\x80\x80", "\xf4\x90\x80\x80", "\x80", "\x1b[2J", "\x7f"}) {
    EXPECT_FALSE(is_plain_text(bad)) << static_cast<int>(static_cast<unsigned char>(bad[0]));
  }
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
