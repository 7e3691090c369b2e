#include "server/keys/once_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <thread>

#include "server/base/read_file.h"
#include "server/keys/secret.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using Found = OnceLinks::Found;

constexpr std::int64_t kNow = 1'800'000'000;

class OnceLinksTest : public ::testing::Test {
 protected:
  Found take(const std::string& token, std::int64_t now) const {
    const auto taken = links.take(token, now);
    EXPECT_TRUE(taken) << taken.message();
    return taken ? taken->found : Found::kUnknown;
  }
  TempFolder folder;
  OnceLinks links{folder.path() + "/keys"};
};

TEST_F(OnceLinksTest, ALinkIsGoodOnce) {
  const auto made = links.make(Role::kObserver, 600, kNow);
  ASSERT_TRUE(made) << made.message();
  EXPECT_THAT(made->token, SizeIs(32)) << "128 bits in hexadecimal digits";
  const auto taken = links.take(made->token, kNow + 1);
  ASSERT_TRUE(taken) << taken.message();
  EXPECT_EQ(taken->found, Found::kGood);
  EXPECT_EQ(taken->link.role, Role::kObserver);
  EXPECT_EQ(taken->link.id, made->link.id);
  EXPECT_EQ(take(made->token, kNow + 2), Found::kUsed);
  EXPECT_EQ(take(made->token, kNow + 2000), Found::kUsed) << "and not only expired";
}

TEST_F(OnceLinksTest, ALinkIsGoodForItsTimeAlone) {
  const auto made = links.make(Role::kOperator, 600, kNow);
  ASSERT_TRUE(made);
  EXPECT_EQ(take(made->token, kNow + 600), Found::kExpired);
  EXPECT_EQ(take(made->token, kNow - 3600), Found::kExpired) << "a clock that was set back";
  EXPECT_EQ(take(made->token, kNow + 599), Found::kGood);
}

TEST_F(OnceLinksTest, AnotherTokenIsUnknown) {
  const auto made = links.make(Role::kOperator, 600, kNow);
  ASSERT_TRUE(made);
  std::string other = made->token;
  other.back() = other.back() == '0' ? '1' : '0';
  for (const std::string& token : {other, std::string(), made->token.substr(1), made->link.hash}) {
    EXPECT_EQ(take(token, kNow), Found::kUnknown) << token;
  }
  EXPECT_EQ(take(made->token, kNow), Found::kGood) << "what others tried changes nothing";
}

TEST_F(OnceLinksTest, OfManyWhoOpenItAtOnceOneIsLetIn) {
  for (int round = 0; round < 20; ++round) {
    const auto made = links.make(Role::kOperator, 600, kNow);
    ASSERT_TRUE(made) << made.message();
    std::atomic<int> good{0}, used{0};
    std::vector<std::thread> all;
    for (int i = 0; i < 4; ++i) {
      all.emplace_back([&] {
        const auto taken = OnceLinks(folder.path() + "/keys").take(made->token, kNow);
        if (taken && taken->found == Found::kGood) ++good;
        if (taken && taken->found == Found::kUsed) ++used;
      });
    }
    for (std::thread& each : all) each.join();
    EXPECT_EQ(good, 1);
    EXPECT_EQ(used, 3);
  }
}

TEST_F(OnceLinksTest, TheFileHasNoTokenAndIsForItsOwnerAlone) {
  const auto made = links.make(Role::kOperator, 600, kNow);
  ASSERT_TRUE(made);
  const auto text = read_file(links.path(), 10000);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, Not(HasSubstr(made->token)));
  EXPECT_THAT(*text, HasSubstr(made->link.hash));
  struct stat info {};
  ASSERT_EQ(::stat(links.path().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777u, 0600u);
  ASSERT_EQ(::chmod(links.path().c_str(), 0644), 0);
  EXPECT_THAT(links.take(made->token, kNow).message(), HasSubstr("mode 0644"));
}

TEST_F(OnceLinksTest, OneThatIsRemovedIsUnknownAndTheStampTellsOfIt) {
  const auto made = links.make(Role::kOperator, 600, kNow);
  ASSERT_TRUE(made);
  const std::string before = links.stamp();
  const auto removed = links.remove(made->link.id, kNow);
  ASSERT_TRUE(removed) << removed.message();
  EXPECT_NE(links.stamp(), before);
  EXPECT_EQ(take(made->token, kNow), Found::kUnknown);
  EXPECT_THAT(links.remove("nobody", kNow).message(), HasSubstr("there is no link 'nobody'"));
}

TEST_F(OnceLinksTest, WhatIsLongOverMakesRoomAndTooManyAreRefused) {
  for (std::size_t i = 0; i < OnceLinks::kMost; ++i) {
    ASSERT_TRUE(links.make(Role::kObserver, 60, kNow));
  }
  EXPECT_THAT(links.make(Role::kObserver, 60, kNow).message(), HasSubstr("there are 64 links"));
  const std::int64_t later = kNow + 60 + OnceLinks::kSessionLife;
  EXPECT_THAT(*links.list(later - 1), SizeIs(OnceLinks::kMost));
  EXPECT_TRUE(links.make(Role::kObserver, 60, later));
  EXPECT_THAT(*links.list(later), SizeIs(1));
}

TEST(Secrets, AreLongAndNeverTheSame) {
  const auto a = new_secret(), b = new_secret();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->size(), 32u);
  EXPECT_NE(*a, *b);
}

TEST(OnceLinksFile, SaysWhichLineIsWrong) {
  const std::string good = "0a1b2c operator 10 20 0 " + std::string(64, 'a');
  EXPECT_TRUE(parse_once_links("# \n\n" + good + "\n", "links"));
  for (const std::string& bad :
       {"0a1b2c master 10 20 0 " + std::string(64, 'a'), std::string("0a1b2c operator 10 20 0 abc"),
        good + " more", "0a1b2c operator 30 20 0 " + std::string(64, 'a'), std::string("nonsense"),
        "0A1B2C operator 10 20 0 " + std::string(64, 'a'),
        "0a1b2c operator 10 20 -1 " + std::string(64, 'a')}) {
    EXPECT_THAT(parse_once_links(good + "\n" + bad, "links").message(), HasSubstr("links:2: "))
        << bad;
  }
}

}  // namespace
}  // namespace handrail
