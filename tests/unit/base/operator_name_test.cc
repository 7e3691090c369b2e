#include "server/base/operator_name.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(OperatorName, IsOneToThirtyTwoPlainLetters) {
  for (const char* good : {"a", "Anna.B_c-9", "abcdefghijklmnopqrstuvwxyz012345"}) {
    EXPECT_TRUE(is_operator_name(good)) << good;
  }
  for (const char* bad : {"", "a b", "ann\n", "\xc3\xa4", "abcdefghijklmnopqrstuvwxyz0123456"}) {
    EXPECT_FALSE(is_operator_name(bad)) << bad;
  }
}

TEST(OperatorName, ABadOneIsQuotedInPart) {
  EXPECT_EQ(operator_name_problem("anna"), "");
  EXPECT_EQ(operator_name_problem("a b"),
            "'a b' is no name: expected 1 to 32 letters, digits, '.', '_', '-'");
  EXPECT_LT(operator_name_problem(std::string(10'000, 'x')).size(), 120u);
}

}  // namespace
}  // namespace handrail
