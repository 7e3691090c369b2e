#include "server/daemon/daemon_args.h"

#include <gtest/gtest.h>

#include <vector>

namespace handrail {
namespace {

Result<DaemonArgs> parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "handrail-rig");
  return parse_daemon_args(static_cast<int>(arguments.size()), arguments.data());
}

TEST(DaemonArgs, NothingMeansDefaults) {
  const auto args = parse({});
  ASSERT_TRUE(args);
  EXPECT_EQ(args->config_path, "");
  EXPECT_FALSE(args->check || args->help || args->version);
}

TEST(DaemonArgs, ReadsEveryOptionInAnyOrder) {
  const auto args = parse({"--check", "--config", "rig.txtpb", "--version", "--help"});
  ASSERT_TRUE(args) << args.message();
  EXPECT_EQ(args->config_path, "rig.txtpb");
  EXPECT_TRUE(args->check && args->help && args->version);
  EXPECT_EQ(parse({"--config=a=b"})->config_path, "a=b");
  EXPECT_TRUE(parse({"-h"})->help);
}

TEST(DaemonArgs, NamesAnUnknownArgument) {
  for (const char* unknown : {"--chekc", "-c", "rig.txtpb", "", "--check=1"}) {
    const auto args = parse({unknown});
    ASSERT_FALSE(args) << unknown;
    EXPECT_EQ(args.message().find("argument '" + std::string(unknown)), 0u) << args.message();
  }
}

TEST(DaemonArgs, WantsAFileBehindConfig) {
  EXPECT_FALSE(parse({"--config"}));
  EXPECT_FALSE(parse({"--config="}));
  EXPECT_FALSE(parse({"--config", "--check"}));
}

TEST(DaemonArgs, RefusesASecondConfig) {
  const auto args = parse({"--config", "a", "--config", "b"});
  ASSERT_FALSE(args);
  EXPECT_NE(args.message().find("twice"), std::string::npos);
}

TEST(DaemonArgs, ReadsWhatADaemonHasBesideTheUsual) {
  const DaemonOption options[] = {{"--link", "", &DaemonArgs::link},
                                  {"--operators", "", &DaemonArgs::operators}};
  const char* const given[] = {"handrail-master", "--operators", "any", "--link=cell"};
  const auto args = parse_daemon_args(4, given, options);
  ASSERT_TRUE(args) << args.message();
  EXPECT_EQ(args->operators, "any");
  EXPECT_EQ(args->link, "cell");
  EXPECT_EQ(
      parse({"--operators", "any"}).message(),
      "argument '--operators': unknown, expected --config FILE, --check, --help or --version");
  const char* const without[] = {"handrail-master", "--operators"};
  EXPECT_EQ(parse_daemon_args(2, without, options).message(),
            "argument '--operators': expected an address or a host after it");
}

TEST(DaemonArgs, HelpNamesProgramPurposeAndOptions) {
  const std::string help = daemon_help("handrail-rig", "Simulates an arm.");
  for (const char* part : {"handrail-rig", "Simulates an arm.", "--config", "--check", "--help"}) {
    EXPECT_NE(help.find(part), std::string::npos) << part;
  }
}

}  // namespace
}  // namespace handrail
