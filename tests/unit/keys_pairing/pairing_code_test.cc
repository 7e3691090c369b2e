#include "server/keys/pairing/pairing_code.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace handrail {
namespace {

TEST(PairingCode, IsReadAsItIsShownAndAsPeopleTypeIt) {
  for (const char* text : {"482-9137", "4829137", " 482 91 37\r\n", "4-8-2-9-1-3-7"}) {
    const auto code = PairingCode::parse(text);
    ASSERT_TRUE(code) << text;
    EXPECT_EQ(code->digits(), "4829137");
    EXPECT_EQ(code->text(), "482-9137");
  }
}

TEST(PairingCode, WhatIsNoneIsRefusedAndNotRepeated) {
  for (const std::string& text : {std::string(), std::string("482913"), std::string("48291370"),
                                  std::string("482-913x"), std::string(1000000, '1'),
                                  std::string("48\0"
                                              "29137",
                                              8)}) {
    const auto code = PairingCode::parse(text);
    ASSERT_FALSE(code) << text.substr(0, 20);
    EXPECT_NE(code.message().find("expected 7 digits"), std::string::npos);
    EXPECT_EQ(code.message().find("48291"), std::string::npos);
  }
}

TEST(PairingCode, EachDigitIsDrawnAsOftenAsAnyOther) {
  constexpr int kDraws = 5000;
  std::array<std::array<int, 10>, PairingCode::kDigits> counts{};
  std::set<std::string> drawn;
  for (int i = 0; i < kDraws; ++i) {
    const auto code = PairingCode::make();
    ASSERT_TRUE(code);
    ASSERT_EQ(code->digits().size(), 7u);
    drawn.insert(code->digits());
    for (std::size_t place = 0; place < counts.size(); ++place) {
      ++counts[place][static_cast<std::size_t>(code->digits()[place] - '0')];
    }
  }
  // 500 expected, standard deviation 21: one of 70 beyond 6 of them comes once in 10^7 runs.
  for (const auto& place : counts) {
    for (const int count : place) EXPECT_NEAR(count, kDraws / 10.0, 128);
  }
  // 1.2 pairs alike are expected of 5000 of 10^7; over 15 come once in 10^12 runs.
  EXPECT_GT(drawn.size(), kDraws - 15u);
}

}  // namespace
}  // namespace handrail
