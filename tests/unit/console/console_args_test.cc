#include "client/console/console_args.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handrail {
namespace {

using ::testing::HasSubstr;

Result<ConsoleArgs> parsed(std::vector<const char*> words) {
  words.insert(words.begin(), "handrail-console");
  return parse_console_args(static_cast<int>(words.size()), words.data());
}

TEST(ConsoleArgs, AreForThisComputerAlone) {
  const auto usual = parsed({"--socket", "/run/op.sock"});
  ASSERT_TRUE(usual) << usual.message();
  EXPECT_EQ(usual->address, "127.0.0.1");
  EXPECT_EQ(usual->port, 0);
  EXPECT_EQ(usual->as, "console");
  EXPECT_FALSE(usual->observe);
  const auto chosen = parsed({"--listen=127.0.3.233:8080", "--observe", "--scenes", "a", "--scenes",
                              "b", "--socket", "x"});
  ASSERT_TRUE(chosen) << chosen.message();
  EXPECT_EQ(chosen->address, "127.0.3.233");
  EXPECT_EQ(chosen->port, 8080);
  EXPECT_TRUE(chosen->observe);
  EXPECT_EQ(chosen->scenes, (std::vector<std::string>{"a", "b"}));
}

TEST(ConsoleArgs, RefuseAnAddressThatOthersReach) {
  for (const char* place : {"0.0.0.0:8080", "192.168.1.2:80", "any", "[::]:80", "somewhere:80"}) {
    EXPECT_THAT(parsed({"--listen", place}).message(),
                HasSubstr("expected an address that only this computer reaches"))
        << place;
  }
}

TEST(ConsoleArgs, NameThePagesThatMayLookAsViewers) {
  const auto args = parsed(
      {"--viewer-origin", "https://app.foxglove.dev", "--viewer-origin=file://", "--socket", "x"});
  ASSERT_TRUE(args) << args.message();
  EXPECT_EQ(args->viewer_origins,
            (std::vector<std::string>{"https://app.foxglove.dev", "file://"}));
  for (const char* origin : {"null", "*", "app.foxglove.dev", "https://a/b", "https://a?b", "://a",
                             "https://*.dev", "https://a b"}) {
    EXPECT_THAT(parsed({"--viewer-origin", origin}).message(),
                HasSubstr("expected the origin of a viewer's page"))
        << origin;
  }
}

TEST(ConsoleArgs, SayWhatIsWrong) {
  EXPECT_THAT(parsed({"--port", "1"}).message(), HasSubstr("unknown argument '--port'"));
  EXPECT_THAT(parsed({"--as", "two words"}).message(), HasSubstr("--as"));
  EXPECT_THAT(parsed({"--as"}).message(), HasSubstr("--as: expected NAME"));
  EXPECT_THAT(parsed({"--page=", "x"}).message(), HasSubstr("--page: expected FOLDER"));
  EXPECT_THAT(parsed({"--as", "a", "--as", "b"}).message(), HasSubstr("--as is given twice"));
  EXPECT_THAT(parsed({"--socket", "x", "--master", "y"}).message(), HasSubstr("one of them"));
  EXPECT_THAT(parsed({"--master", "y", "--as", "ann"}).message(), HasSubstr("your key says it"));
}

}  // namespace
}  // namespace handrail
