#include "client/console/gateway/site.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class SiteTest : public ::testing::Test {
 protected:
  SiteTest() {
    folder.write("index.html", "<p>page</p>");
    folder.write("app.js", "1");
    folder.write(".hidden.js", "2");
    folder.write("notes.md", "3");
    folder.write("two words.js", "4");
    std::filesystem::create_directory(folder.path() + "/deep.js");
  }
  TempFolder folder;
};

TEST_F(SiteTest, ServesWhatLiesInTheFolderWithATypeOfItsOwn) {
  const auto site = Site::read(folder.path());
  ASSERT_TRUE(site) << site.message();
  EXPECT_EQ(site->size(), 2u);
  EXPECT_EQ(*site->find("/")->body, "<p>page</p>");
  EXPECT_EQ(site->find("/app.js?v=3")->type, "text/javascript; charset=utf-8");
}

TEST_F(SiteTest, NothingBesideTheTableIsServed) {
  const auto site = Site::read(folder.path());
  ASSERT_TRUE(site);
  for (const char* target : {"/../secret", "/..%2fsecret", "//app.js", "/./app.js", "/.hidden.js",
                             "/notes.md", "/two words.js", "/two%20words.js", "/deep.js", "",
                             "app.js", "/index.html/../app.js", "/etc/passwd", "\\..\\x"}) {
    EXPECT_FALSE(site->find(target)) << target;
  }
}

TEST_F(SiteTest, WhatComesLaterIsNotRead) {
  const auto site = Site::read(folder.path());
  ASSERT_TRUE(site);
  folder.write("late.js", "5");
  EXPECT_FALSE(site->find("/late.js"));
}

TEST_F(SiteTest, SaysWhichFolderHasNoPage) {
  EXPECT_THAT(Site::read(folder.path() + "/nowhere").message(), HasSubstr("/nowhere: "));
  std::filesystem::remove(folder.path() + "/index.html");
  EXPECT_THAT(Site::read(folder.path()).message(), HasSubstr("there is no index.html"));
}

TEST(SiteWithoutPage, SaysWhyAndEscapesIt) {
  const Site site = Site::without_page("<script>alert(1)</script> & co");
  const std::string body = *site.find("/")->body;
  EXPECT_THAT(body, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt; &amp; co"));
}

}  // namespace
}  // namespace handrail
