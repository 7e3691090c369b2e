// The command line is read as it is meant, and what is wrong with it is said.
#include "tests/emulator/netfault_args.h"

#include <gtest/gtest.h>

namespace handrail::emulator {
namespace {

using Words = std::vector<std::string>;

std::string error_of(Words words) {
  for (const char* word : {"--", "near:", "true"}) words.emplace_back(word);
  return read_args(words).message();
}

TEST(NetfaultArgsTest, ReadsBothCommandsAndLeavesADashDashOfTheirOwn) {
  const auto args =
      read_args({"--seed", "7", "--", "far:", "b", "--", "c", "--", "near:", "a", "-x"});
  ASSERT_TRUE(args.is_ok()) << args.message();
  EXPECT_EQ(args->near, (Words{"a", "-x"}));
  EXPECT_EQ(args->far, (Words{"b", "--", "c"}));
  EXPECT_EQ(args->options.seed, 7u);
  EXPECT_EQ(args->until, Until::kAny);
}

TEST(NetfaultArgsTest, ChangesAreMadeToTheNetworkThatWasNamed) {
  const auto args = read_args({"--network", "far", "--set", "to_far { loss: 0.5 }", "--set",
                               "to_near { delay_ms: 1 }", "--mtu", "1280", "--json", "--until",
                               "both", "--share", "/tmp/../tmp", "--", "near:", "a"});
  ASSERT_TRUE(args.is_ok()) << args.message();
  EXPECT_EQ(args->options.plan.to_far.loss, 0.5);
  EXPECT_EQ(args->options.plan.to_far.delay, 50 * kMillisecond);
  EXPECT_EQ(args->options.plan.to_near.delay, kMillisecond);
  EXPECT_EQ(args->options.mtu, 1280);
  EXPECT_TRUE(args->json);
  EXPECT_EQ(args->until, Until::kBoth);
  EXPECT_EQ(args->options.shared, Words{"/tmp"});
}

TEST(NetfaultArgsTest, ASeedIsDrawnWhereNoneIsGiven) {
  const Words words = {"--", "near:", "a"};
  const auto first = read_args(words), second = read_args(words), third = read_args(words);
  ASSERT_TRUE(first && second && third);
  EXPECT_FALSE(first->options.seed == second->options.seed &&
               second->options.seed == third->options.seed);
}

TEST(NetfaultArgsTest, OrdersAloneAreEnoughToRun) {
  EXPECT_TRUE(read_args({"--orders", "-"}).is_ok());
  EXPECT_EQ(read_args({}).message(),
            "nothing to run: expected -- near: CMD ... -- far: CMD ..., or --orders");
}

TEST(NetfaultArgsTest, ErrorsNameTheWordAndWhatWasExpected) {
  EXPECT_EQ(error_of({"--untill", "any"}), "'--untill': did you mean --until?");
  EXPECT_EQ(error_of({"--seed", "-1"}), "--seed '-1': expected a whole number from 0 on");
  EXPECT_EQ(error_of({"--mtu", "1279"}), "--mtu '1279': expected 1280 to 1500");
  EXPECT_EQ(error_of({"--mtu", "1501"}), "--mtu '1501': expected 1280 to 1500");
  EXPECT_EQ(error_of({"--until", "x"}), "--until 'x': expected near, far, any or both");
  EXPECT_EQ(error_of({"--until", "far"}), "--until far: nothing runs there");
  EXPECT_EQ(error_of({"--tap-bytes", "0"}), "--tap-bytes '0': expected 1 to 1500");
  EXPECT_EQ(error_of({"--tap", "/nowhere"}), "--tap '/nowhere': expected a folder that exists");
  EXPECT_EQ(error_of({"--", "x"}), "'x' behind '--': expected near: or far:");
  EXPECT_EQ(error_of({"--", "near:", "x"}), "'near:': given twice");
  EXPECT_EQ(read_args({"--seed"}).message(), "--seed: its value is missing");
}

}  // namespace
}  // namespace handrail::emulator
