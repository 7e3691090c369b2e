// The command line of handrail-faults, and what it keeps.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/faults/faults_args.h"
#include "tests/faults/kept.h"
#include "tests/support/temp_folder.h"

namespace handrail::faults {
namespace {

using ::testing::HasSubstr;

TEST(FaultsArgs, WithoutAWordItIsTheQuickFormOfAllRowsAtADrawnSeed) {
  const auto args = read_faults_args({});
  ASSERT_TRUE(args.is_ok());
  EXPECT_EQ(args->rows.size(), all_rows().size());
  EXPECT_FALSE(args->full || args->json || args->resume || args->seeded);
}

TEST(FaultsArgs, RowsSeedAndFormAreTaken) {
  const auto args = read_faults_args({"--full", "N2", "--seed", "42", "P1", "--resume", "--json"});
  ASSERT_TRUE(args.is_ok()) << args.message();
  ASSERT_EQ(args->rows.size(), 2u);
  EXPECT_STREQ(args->rows[1]->id, "P1");
  EXPECT_TRUE(args->full && args->json && args->resume && args->seeded);
  EXPECT_EQ(args->seed, 42u);
}

TEST(FaultsArgs, WrongWordsAreNamedWithWhatWasExpected) {
  EXPECT_THAT(read_faults_args({"N99"}).message(),
              HasSubstr("N99: expected an option, or a row of N1, N2"));
  EXPECT_EQ(read_faults_args({"--seed"}).message(), "--seed: its value is missing");
  EXPECT_EQ(read_faults_args({"--seed", "x"}).message(),
            "--seed 'x': expected a whole number from 0 on");
}

TEST(KeptResults, ARowThatPassedIsKnownAtItsCommitFormAndSeed) {
  const TempFolder folder;
  const KeptResults kept(folder.path() + "/r", "abc", false);
  EXPECT_FALSE(kept.passed("N2", std::nullopt).has_value());
  RowResult result;
  result.done = "PASS in words";
  ASSERT_TRUE(kept.add("N2", 7, result));
  result.outcome = Outcome::kFailed;
  ASSERT_TRUE(kept.add("N3", 7, result));
  EXPECT_EQ(kept.passed("N2", std::nullopt), 7u);
  EXPECT_EQ(kept.passed("N2", 7), 7u);
  EXPECT_FALSE(kept.passed("N2", 8).has_value());
  EXPECT_FALSE(kept.passed("N3", std::nullopt).has_value()) << "it failed";
  EXPECT_FALSE(KeptResults(folder.path() + "/r", "abc", true).passed("N2", 7).has_value());
  EXPECT_FALSE(KeptResults(folder.path() + "/r", "abd", false).passed("N2", 7).has_value());
}

TEST(KeptResults, WithoutACommitNothingIsKept) {
  const TempFolder folder;
  const KeptResults kept(folder.path() + "/r", "", false);
  ASSERT_TRUE(kept.add("N2", 7, {}));
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/r"));
}

TEST(FaultLines, AreOneLineEachWhateverWasFound) {
  RowResult result;
  result.outcome = Outcome::kFailed;
  result.why = "a\nb \"c\"";
  EXPECT_EQ(for_people("N2", result, 1.0).find('\n'), std::string::npos);
  EXPECT_THAT(for_people("N2", result, 1.0), HasSubstr("N2   FAIL   1 s"));
  EXPECT_THAT(to_json("N2", 3, false, result, 1.5), HasSubstr(R"("why":"a b \"c\"")"));
}

}  // namespace
}  // namespace handrail::faults
