#include "devices/spacemouse/spnav_stream.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "tests/support/spnav_server.h"

namespace handrail {
namespace {

using test::spnav_button;
using test::spnav_device;
using test::spnav_motion;
using test::SpnavWords;

std::vector<std::uint8_t> bytes_of(const SpnavWords& words) {
  std::vector<std::uint8_t> out(sizeof words);
  std::memcpy(out.data(), words.data(), sizeof words);
  return out;
}

std::vector<std::uint8_t> word_bytes(std::uint32_t word) {
  std::vector<std::uint8_t> out(sizeof word);
  std::memcpy(out.data(), &word, sizeof word);
  return out;
}

bool take(SpnavStream& stream, const SpnavWords& words) { return stream.take(bytes_of(words)); }

TEST(SpnavStream, AMotionHasSixCounts) {
  SpnavStream stream;
  ASSERT_TRUE(take(stream, spnav_motion({10, -20, 30, -40, 50, -60})));
  EXPECT_EQ(stream.state().counts, (std::array<std::int32_t, 6>{10, -20, 30, -40, 50, -60}));
  EXPECT_EQ(stream.state().motions, 1u);
}

TEST(SpnavStream, ItIsTakenHoweverItIsCut) {
  std::vector<std::uint8_t> all = word_bytes(0x7faa5501);
  for (const SpnavWords& words : {spnav_motion({1, 2, 3, 4, 5, 6}), spnav_button(4, true),
                                  spnav_motion({7, 8, 9, 10, 11, 12})}) {
    const auto more = bytes_of(words);
    all.insert(all.end(), more.begin(), more.end());
  }
  for (std::size_t piece = 1; piece <= all.size(); ++piece) {
    SpnavStream stream;
    for (std::size_t at = 0; at < all.size(); at += piece) {
      const std::size_t n = std::min(piece, all.size() - at);
      ASSERT_TRUE(stream.take({all.data() + at, n})) << piece;
    }
    EXPECT_EQ(stream.protocol(), 1) << piece;
    EXPECT_EQ(stream.state().counts[5], 12) << piece;
    EXPECT_EQ(stream.state().buttons, 1u << 4) << piece;
  }
}

// Events go to a client as soon as it has connected, before its question is answered.
TEST(SpnavStream, TheAnswerAboutTheProtocolMayComeAfterEvents) {
  SpnavStream stream;
  ASSERT_TRUE(take(stream, spnav_motion({1, 0, 0, 0, 0, 0})));
  EXPECT_EQ(stream.protocol(), 0);
  ASSERT_TRUE(stream.take(word_bytes(0x7faa5501)));
  EXPECT_EQ(stream.protocol(), 1);
  ASSERT_TRUE(take(stream, spnav_motion({2, 0, 0, 0, 0, 0})));
  EXPECT_EQ(stream.state().counts[0], 2);
}

TEST(SpnavStream, ButtonsGoDownAndUp) {
  SpnavStream stream;
  ASSERT_TRUE(take(stream, spnav_button(0, true)));
  ASSERT_TRUE(take(stream, spnav_button(31, true)));
  EXPECT_EQ(stream.state().buttons, 1u | 1u << 31);
  ASSERT_TRUE(take(stream, spnav_button(0, false)));
  EXPECT_EQ(stream.state().buttons, 1u << 31);
  ASSERT_TRUE(take(stream, spnav_button(32, true))) << "more than we count is none of ours";
  EXPECT_EQ(stream.state().buttons, 1u << 31);
}

TEST(SpnavStream, WhatIsTakenAwayIsPushedByNobody) {
  SpnavStream stream;
  ASSERT_TRUE(take(stream, spnav_motion({300, 0, 0, 0, 0, 0})));
  ASSERT_TRUE(take(stream, spnav_button(2, true)));
  ASSERT_TRUE(take(stream, spnav_device(false)));
  EXPECT_TRUE(stream.state().unplugged);
  EXPECT_EQ(stream.state().counts[0], 0);
  EXPECT_EQ(stream.state().buttons, 0u);
  ASSERT_TRUE(take(stream, spnav_device(true)));
  EXPECT_FALSE(stream.state().unplugged);
}

// One of two was taken away; the other moves.
TEST(SpnavStream, WhatMovesIsThere) {
  for (const SpnavWords& words : {spnav_motion({1, 0, 0, 0, 0, 0}), spnav_button(1, true)}) {
    SpnavStream stream;
    ASSERT_TRUE(take(stream, spnav_device(false)));
    ASSERT_TRUE(take(stream, words));
    EXPECT_FALSE(stream.state().unplugged);
  }
}

TEST(SpnavStream, WhatIsNotSpacenavdsEndsIt) {
  for (const SpnavWords& words :
       {SpnavWords{7}, SpnavWords{-1}, SpnavWords{0x2000}, SpnavWords{1, -1}, SpnavWords{3, 2}}) {
    SpnavStream stream;
    EXPECT_FALSE(take(stream, words)) << words[0];
    EXPECT_FALSE(take(stream, spnav_motion({1, 1, 1, 1, 1, 1}))) << "nothing after it is trusted";
    EXPECT_EQ(stream.state().motions, 0u);
    stream.reset();
    EXPECT_TRUE(take(stream, spnav_motion({1, 1, 1, 1, 1, 1})));
  }
}

TEST(SpnavStream, WhatWeDidNotAskForIsPassedOver) {
  SpnavStream stream;
  for (const std::int32_t type : {4, 5, 6}) ASSERT_TRUE(take(stream, SpnavWords{type, 9, 9}));
  EXPECT_EQ(stream.state().motions, 0u);
  EXPECT_EQ(stream.state().buttons, 0u);
}

}  // namespace
}  // namespace handrail
