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

TEST(ConsoleArgs, AnAddressThatOthersReachIsEncryptedAndFoundByItsNames) {
  const auto remote =
      parsed({"--listen", "192.0.2.7", "--name", "Desk.Example.org", "--socket", "x"});
  ASSERT_TRUE(remote) << remote.message();
  EXPECT_TRUE(remote->encrypted);
  EXPECT_EQ(remote->port, 47004) << "one that a firewall can know";
  EXPECT_EQ(remote->names, (std::vector<std::string>{"desk.example.org", "192.0.2.7"}));
  for (const char* place : {"0.0.0.0:80", "[::]:80", "any:80"}) {
    const auto any = parsed({"--listen", place, "--name", "desk", "--socket", "x"});
    ASSERT_TRUE(any) << any.message();
    EXPECT_TRUE(any->encrypted) << place;
    EXPECT_EQ(any->address, "any");
    EXPECT_EQ(any->names, std::vector<std::string>{"desk"});
  }
  EXPECT_TRUE(parsed({"--listen", "[::1]:80", "--socket", "x"})->encrypted);
  EXPECT_FALSE(parsed({"--listen", "127.9.9.9:80", "--socket", "x"})->encrypted);
  EXPECT_EQ(parsed({"--listen", "127.9.9.9", "--socket", "x"})->port, 0);
}

TEST(ConsoleArgs, SayWhichNamesAreMissingOrNone) {
  EXPECT_THAT(parsed({"--listen", "any"}).message(), HasSubstr("expected --name HOST too"));
  EXPECT_THAT(parsed({"--name", "desk"}).message(), HasSubstr("--name: expected with --listen"));
  for (const char* name : {"desk:80", "a,b", "two words", "a/b"}) {
    EXPECT_THAT(parsed({"--listen", "any", "--name", name}).message(),
                HasSubstr("expected a name or an address"))
        << name;
  }
  EXPECT_THAT(parsed({"--listen", "somewhere:80"}).message(),
              HasSubstr("expected any, or an address of this computer"));
}

TEST(ConsoleArgs, NameThePagesThatMayLookAsViewers) {
  const auto args = parsed({"--viewer-origin", "https://app.foxglove.dev",
                            "--viewer-origin=file://", "--socket", "x", "--rig", "/run/rig.sock"});
  ASSERT_TRUE(args) << args.message();
  EXPECT_EQ(args->rig, "/run/rig.sock");
  EXPECT_EQ(args->viewer_origins,
            (std::vector<std::string>{"https://app.foxglove.dev", "file://"}));
  for (const char* origin : {"null", "*", "app.foxglove.dev", "https://a/b", "https://a?b", "://a",
                             "https://*.dev", "https://a b"}) {
    EXPECT_THAT(parsed({"--viewer-origin", origin}).message(),
                HasSubstr("expected the origin of a viewer's page"))
        << origin;
  }
  EXPECT_THAT(
      parsed({"--listen", "192.0.2.7", "--viewer-origin", "file://", "--socket", "x"}).message(),
      HasSubstr("viewers are served on this computer alone"));
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

TEST(ConsoleArgs, ARecordingTakesThePlaceOfAMaster) {
  const auto shown = parsed({"--recording", "a.mcap", "--json", "--listen", "127.0.0.1:8080"});
  ASSERT_TRUE(shown) << shown.message();
  EXPECT_EQ(shown->recording, "a.mcap");
  EXPECT_TRUE(shown->json);
  EXPECT_EQ(shown->port, 8080);
  EXPECT_EQ(shown->as, "");
  for (const char* other : {"--socket", "--master", "--as", "--rig", "--scenes"}) {
    EXPECT_THAT(parsed({"--recording", "a.mcap", other, "desk"}).message(),
                HasSubstr(std::string("--recording and ") + other + ": expected one of them"));
  }
  EXPECT_THAT(parsed({"--recording"}).message(), HasSubstr("--recording: expected FILE.mcap"));
  ::setenv("HANDRAIL_MASTER", "no:such:host", 1);
  EXPECT_TRUE(parsed({"--recording", "a.mcap"})) << "no master is asked for";
  ::unsetenv("HANDRAIL_MASTER");
}

}  // namespace
}  // namespace handrail
