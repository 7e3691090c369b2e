// The fault matrix as a program: its rows, what it prints, and that a seed repeats a run.
#include "server/lab/faults/fault_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "server/lab/faults/fault_command.h"
#include "server/lab/faults/fault_proof.h"
#include "server/lab/faults/fault_runner.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::atomic<bool> kGoOn = false;

FaultOutcome odd_ones_fail(const RowRun& row) {
  FaultOutcome out;
  measure(out, 10.0 * row.index, 25.0);
  find(out, row.index % 2 == 1 ? 2 : 0, "oddities");
  return out;
}
FaultOutcome pushes_on(const RowRun& row) {
  FaultOutcome out;
  out.harder = 10.0 * row.index;
  out.deeper = 1.0 - 0.5 * row.index;
  return out;
}
FaultOutcome never_measured(const RowRun&) { return {}; }

std::vector<FaultResult> results_of(const std::vector<FaultRow>& rows, std::uint64_t seed,
                                    int threads) {
  return run_faults({rows, {seed}, false, threads}, kGoOn).value();
}

TEST(FaultRowsTest, EveryRowHasANameOfItsOwnAndRuns) {
  std::set<std::string> names;
  for (const FaultRow& row : fault_rows()) {
    EXPECT_TRUE(names.insert(row.id).second) << row.id;
    EXPECT_GT(row.quick_runs, 0) << row.id;
    EXPECT_LE(row.quick_runs, row.runs) << row.id;
  }
  for (const char* id :
       {"N2",  "N3",  "N4",  "N5",  "N6",  "N9",  "N11", "N13", "P1",  "P5",  "C2",
        "S4",  "S5",  "X2a", "X2b", "X9a", "X9b", "N3c", "P1c", "S1d", "S2c", "S3c",
        "S3d", "S3e", "S1e", "S1f", "S2d", "S2e", "R1c", "P8",  "R1a", "R3b"}) {
    EXPECT_EQ(names.count(id), 1u) << id;
  }
}

TEST(FaultRowsTest, ARowTellsHowMuchItsStopsPushOn) {
  const std::vector<FaultRow> rows = {{"T1", "a test", "N", 3, 3, pushes_on},
                                      {"T2", "another", "N", 2, 2, never_measured}};
  const std::string table = fault_table(results_of(rows, 1, 2));
  EXPECT_THAT(table,
              HasSubstr("T1: a stop that had set in still pushed up to 20 N harder, 1.0 mm"));
  EXPECT_THAT(table, Not(HasSubstr("T2: a stop")));
}

TEST(FaultRowsTest, TheWorstRunIsTheOneNearestToItsBound) {
  const std::vector<FaultRow> rows = {{"T1", "a test", "ms", 5, 5, odd_ones_fail},
                                      {"T2", "another", "N", 2, 2, never_measured}};
  const auto results = results_of(rows, 1, 2);
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].runs, 5);
  EXPECT_EQ(results[0].violations, 4u);
  EXPECT_EQ(results[0].worst, 40.0);
  EXPECT_EQ(results[0].shown_index, 1);
  EXPECT_EQ(results[0].found, "2 x oddities");
  EXPECT_FALSE(results[1].measured);
  EXPECT_EQ(fault_json(results),
            "{\"rows\": [\n"
            "  {\"row\": \"T1\", \"runs\": 5, \"violations\": 4, \"worst\": 40, \"bound\": 25, "
            "\"unit\": \"ms\", \"seeds_with_violations\": [1]},\n"
            "  {\"row\": \"T2\", \"runs\": 2, \"violations\": 0, \"worst\": 0, \"bound\": 0, "
            "\"unit\": \"N\", \"seeds_with_violations\": []}\n]}\n");
  EXPECT_THAT(fault_table(results), HasSubstr("seed 1, run 1: 2 x oddities"));
}

TEST(FaultRowsTest, NoSuchRowIsBadUsage) {
  FaultCommand command;
  command.row = "N99";
  EXPECT_EQ(run_fault_command(command, kGoOn), 2);
}

TEST(FaultRowsTest, ResultsDependOnTheSeedAndNotOnThreads) {
  std::vector<FaultRow> rows;
  for (const FaultRow& row : fault_rows()) {
    if (std::string(row.id) == "N10a") rows.push_back(row);
  }
  const std::string one = fault_json(results_of(rows, 1, 1));
  EXPECT_EQ(fault_json(results_of(rows, 1, 2)), one);
  EXPECT_NE(fault_json(results_of(rows, 2, 2)), one);
}

TEST(FaultRowsTest, EveryCheckHasARowThatIsToProveIt) {
  const std::span<const FaultRow> rows = fault_rows();
  std::set<std::string> names;
  std::size_t check = 0;
  for (const FaultProof& proof : fault_proofs()) {
    EXPECT_EQ(static_cast<std::size_t>(proof.check), check++);
    EXPECT_TRUE(names.insert(proof.name).second) << proof.name;
    const bool known = std::any_of(rows.begin(), rows.end(), [&](const FaultRow& row) {
      return std::string(row.id) == proof.row && row.runs >= proof.runs;
    });
    EXPECT_TRUE(known) << proof.name;
  }
}

// In the build the programs come from every check is made, and saying otherwise is an error.
TEST(FaultRowsTest, NoCheckCanBeLeftOutOfAnOrdinaryBuild) {
  static_assert(!kDeletable && kept(Check::kFinite) && kept(Check::kStopInput));
  EXPECT_FALSE(delete_check("finite"));
  FaultCommand command;
  command.prove = true;
  EXPECT_EQ(run_fault_command(command, kGoOn), 2);
  command.prove = false;
  command.without = "jerk";
  EXPECT_EQ(run_fault_command(command, kGoOn), 2);
}

TEST(FaultRowsTest, RunsThatFindAreCountedByWhatTheyFind) {
  const FaultRow row{"T1", "a test", "ms", 5, 5, odd_ones_fail};
  EXPECT_EQ(runs_that_find(row, 5, "oddities", 1, 2, kGoOn), 2);
  EXPECT_EQ(runs_that_find(row, 1, "oddities", 1, 1, kGoOn), 0);
  EXPECT_EQ(runs_that_find(row, 5, "others", 1, 1, kGoOn), 0);
}

// Nothing is held against a quiet run, and its hand does move the arm.
TEST(FaultRowsTest, ARunWithoutFaultsIsDrivenAndStaysEngaged) {
  FaultRun run({.seed = 1});
  ASSERT_TRUE(run.engage());
  run.run(5 * kSecond);
  const AuditReport& report = run.auditor().report();
  EXPECT_TRUE(run.engaged());
  EXPECT_EQ(report.stops, 0u);
  EXPECT_EQ(report.of(Breach::kUnled) + report.of(Breach::kUnasked) + report.of(Breach::kSpeed),
            0u);
  EXPECT_GT(report.moved, 600u);
  EXPECT_EQ(run.longest_gap(), kMillisecond);
  EXPECT_EQ(report.fresh, run.cell().net()->slave().snapshot().accepted);
}

TEST(FaultRowsTest, InContactTheHandMeetsASurfaceThatAPlainRunHasNot) {
  for (const bool contact : {false, true}) {
    FaultOptions options;
    options.contact = contact;
    FaultRun run({.seed = 1}, options);
    const Scene::Mapping mapping;
    double down = 0.0;
    run.layers().hand = [&](Nanos, HandReading& hand) {
      hand.X_MH.p = mapping.R_SM.transpose() * Vec3(0.0, 0.0, -down) / mapping.scale;
    };
    ASSERT_TRUE(run.engage());
    for (; down < kFaultGap + 1e-3; down += 1e-5) run.run(kMillisecond);
    run.run(2 * kSecond);
    EXPECT_EQ(run.true_force() > 20.0, contact);
    EXPECT_LT(run.true_force(), 60.0);
    FaultOutcome out = run.outcome();
    EXPECT_EQ(out.violations, 0u) << out.found;
  }
}

// Commands stop at once, the joints come after: by their lag of 45 ms, less what the stop takes
// off.
TEST(FaultRowsTest, InContactAStopPushesOnByWhatTheArmIsBehind) {
  FaultOptions options;
  options.contact = true;
  FaultRun run({.seed = 1}, options);
  const Scene::Mapping mapping;
  double down = 0.0;
  run.layers().hand = [&](Nanos, HandReading& hand) {
    hand.X_MH.p = mapping.R_SM.transpose() * Vec3(0.0, 0.0, -down) / mapping.scale;
  };
  ASSERT_TRUE(run.engage());
  constexpr double kSpeed = 0.02;  // [m/s]
  for (; run.true_force() < 10.0; down += 1e-3 * kSpeed) run.run(kMillisecond);
  run.cell().net()->stop_master(true);
  run.run(kSecond);
  const FaultOutcome out = run.outcome();
  EXPECT_GT(out.deeper, 0.3 * kSpeed * 45.0);
  EXPECT_LT(out.deeper, 1.2 * kSpeed * 45.0);
  EXPECT_NEAR(out.harder, 57.0 * out.deeper, 0.15 * out.harder);
}

// A guard that is not there is found: a stalled thread whose datagrams go on proves nobody alive.
TEST(FaultRowsTest, RepeatedStatesDoNotLeadTheArm) {
  FaultRun run({.seed = 1});
  ASSERT_TRUE(run.engage());
  EXPECT_TRUE(run.auditor().led());
  run.stall_master(true);
  run.run(40 * kMillisecond);
  EXPECT_FALSE(run.auditor().led());
}

TEST(FaultRowsTest, AnotherMastersDatagramsAreNotTheAuthenticOnes) {
  LinkWay way(1, {.longest = 8});
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  way.inject(bytes, 0);
  way.advance(0);
  std::array<std::uint8_t, 8> out{};
  EXPECT_EQ(way.receive(out, 0), 3u);
  ASSERT_EQ(way.deliveries().size(), 1u);
  EXPECT_FALSE(way.deliveries()[0].authentic());
  EXPECT_EQ(way.counters().sent, 0u);
}

}  // namespace
}  // namespace handrail
