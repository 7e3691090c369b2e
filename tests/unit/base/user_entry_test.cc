// What the system knows of its users, asked by several threads.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "server/base/folder_owner.h"

namespace handrail {
namespace {

constexpr uid_t kNobodyHas = 3'999'999'999;

TEST(UserEntry, HasNameAndHomeOfWhoThereIsAndNothingOfWhoThereIsNot) {
  EXPECT_EQ(user_entry(0).name, "root");
  EXPECT_EQ(user_entry(0).home.substr(0, 1), "/");
  EXPECT_EQ(user_entry(kNobodyHas).name, "");
  EXPECT_EQ(user_text(0), "root (uid 0)");
  EXPECT_EQ(user_text(kNobodyHas), "uid 3999999999");
}

TEST(UserEntry, ThreadsThatAskAtOnceGetEachItsOwn) {
  std::atomic<int> wrong{0};
  const auto ask = [&wrong](uid_t user, const std::string& text) {
    for (int i = 0; i < 2000; ++i) wrong += user_text(user) != text ? 1 : 0;
  };
  std::thread other(ask, kNobodyHas, "uid 3999999999");
  ask(0, "root (uid 0)");
  other.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace handrail
