#include "client/console/gateway/outbox.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

Outbox::Item item(const std::string& text, int slot = -1, std::size_t most = 1) {
  return {shared_text(text), false, {slot, most}};
}

std::string all(Outbox& box) {
  std::string out;
  while (const auto next = box.next()) out += *next->frame;
  return out;
}

TEST(Outbox, GivesFramesInTheirOrder) {
  Outbox box;
  for (const char* text : {"a", "b", "c"}) EXPECT_TRUE(box.put(item(text)));
  EXPECT_EQ(all(box), "abc");
  EXPECT_EQ(box.bytes(), 0u);
}

TEST(Outbox, ANewerFrameOfASlotTakesThePlaceOfTheOneThatWaits) {
  Outbox box;
  EXPECT_TRUE(box.put(item("old", 0)));
  EXPECT_TRUE(box.put(item("reply")));
  EXPECT_TRUE(box.put(item("other", 1)));
  EXPECT_TRUE(box.put(item("newest", 0)));
  EXPECT_EQ(box.bytes(), 16u);
  EXPECT_EQ(box.missed(), 1u);
  EXPECT_EQ(all(box), "newestreplyother");
}

TEST(Outbox, OfASlotThatMayWaitSeveralTimesTheOldestIsLeftOut) {
  Outbox box;
  for (const char* text : {"a", "b", "c", "d"}) EXPECT_TRUE(box.put(item(text, 3, 2)));
  EXPECT_TRUE(box.put(item("other", 4, 2)));
  EXPECT_EQ(box.missed(), 2u);
  EXPECT_EQ(box.bytes(), 7u);
  EXPECT_EQ(all(box), "cdother");
}

TEST(Outbox, AMinuteOfStatusesForWhoReadsNothingIsOneFrame) {
  Outbox box;
  for (int i = 0; i < 3600; ++i) ASSERT_TRUE(box.put(item(std::string(5000, 'x'), 0)));
  EXPECT_EQ(box.bytes(), 5000u);
}

TEST(Outbox, RefusesMoreThanAPersonsPageLetsWait) {
  Outbox box;
  for (std::size_t i = 0; i < Outbox::kMostWaiting; ++i) ASSERT_TRUE(box.put(item("x")));
  EXPECT_FALSE(box.put(item("x")));
  Outbox heavy;
  ASSERT_TRUE(heavy.put(item(std::string(Outbox::kMostBytes, 'x'))));
  EXPECT_FALSE(heavy.put(item("x")));
}

}  // namespace
}  // namespace handrail
