#include "client/cli/calibrate_command.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "client/cli/payload_samples.h"
#include "server/scene/config_io.h"
#include "server/scene/payload_io.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/task/payload_samples.h"

namespace handrail {
namespace {

using test::half_a_kilogram;
using test::leaning;
using test::samples_of;

constexpr char kHeader[] = "qw,qx,qy,qz,fx_n,fy_n,fz_n,tx_n_m,ty_n_m,tz_n_m\n";

struct CalibrateRun {
  explicit CalibrateRun(std::vector<std::string> args) {
    args.insert(args.begin(), {"calibrate", "payload"});
    std::ostringstream out_stream, err_stream;
    code = run_cli(args, Console{out_stream, err_stream});
    out = out_stream.str();
    err = err_stream.str();
  }
  ExitCode code;
  std::string out, err;
};

std::string text_in(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string error_in(const std::string& text) {
  return parse_payload_samples("a.csv", text).message();
}

TEST(Calibrate, FindsThePayloadOfARecordingAndWritesItsBlock) {
  const TempFolder folder;
  const auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  const std::string csv = folder.write("a.csv", payload_samples_text(samples));
  const std::string block = folder.path() + "/payload.conf";
  const CalibrateRun run({"--from", csv, "--out", block});
  EXPECT_EQ(run.code, kExitDone) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_NE(run.out.find("mass      0.5000 kg\ncentre    4.00 -2.00 60.00 mm from the tip\n"
                         "bias      1.500 -2.000 0.700 N   0.05000 -0.02000 0.01000 N m\n"
                         "left over 0.000 N, 0.00000 N m (RMS of 6 orientations)\n"),
            std::string::npos)
      << run.out;
  EXPECT_TRUE(run.out.ends_with(text_in(block)));
  const Result<pb::SlaveConfig> config = load_slave_config(block);
  ASSERT_TRUE(config.is_ok()) << config.message();
  EXPECT_NEAR(payload_from(config->payload()).mass, 0.5, 1e-4);
  EXPECT_LT((payload_from(config->payload()).centre_T - half_a_kilogram().centre_T).norm(), 1e-5);
}

TEST(Calibrate, ARecordingGivesTheSameAgain) {
  const TempFolder folder;
  auto samples = samples_of(half_a_kilogram(), leaning(5, 0.6));
  samples[2].force_noise = 0.01;
  samples[3].raw_T.torque.x() += 1.0 / 3.0e7;
  const std::string first = folder.write("a.csv", payload_samples_text(samples));
  const std::string second = folder.path() + "/b.csv";
  EXPECT_EQ(CalibrateRun({"--from", first, "--record", second}).code, kExitDone);
  EXPECT_EQ(text_in(second), text_in(first));
  // To the last bit: a payload that is found live and one of its recording round alike.
  const auto again = load_payload_samples(first);
  ASSERT_TRUE(again.is_ok()) << again.message();
  ASSERT_EQ(again->size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ((*again)[i].q_ST.coeffs(), samples[i].q_ST.coeffs());
    EXPECT_EQ((*again)[i].raw_T.force, samples[i].raw_T.force);
    EXPECT_EQ((*again)[i].raw_T.torque, samples[i].raw_T.torque);
  }
}

TEST(Calibrate, JsonHasPayloadResidualsAndSamples) {
  const TempFolder folder;
  const std::string csv =
      folder.write("a.csv", payload_samples_text(samples_of(half_a_kilogram(), leaning(5, 0.6))));
  const CalibrateRun run({"--from", csv, "--json"});
  EXPECT_EQ(run.code, kExitDone);
  for (const char* key :
       {"\"payload\": {", "\"mass_kg\": 0.", "\"centre_mm\": [", "\"bias_n\": [", "\"bias_n_m\": [",
        "\"force_left_n\": ", "\"torque_left_n_m\": ", "\"sample\": [", "\"quaternion\": ["}) {
    EXPECT_NE(run.out.find(key), std::string::npos) << key;
  }
}

TEST(Calibrate, WhatIsNoCalibrationIsRefusedAndNothingWritten) {
  const TempFolder folder;
  auto reversed = samples_of(half_a_kilogram(), leaning(5, 0.6));
  for (PayloadSample& s : reversed) s.raw_T = {-s.raw_T.force, -s.raw_T.torque};
  auto touched = samples_of(half_a_kilogram(), leaning(5, 0.6));
  touched[1].raw_T.force.x() += 2.0;
  Payload heavy = half_a_kilogram();
  heavy.mass = 30.0;
  const std::pair<std::vector<PayloadSample>, const char*> cases[] = {
      {samples_of(half_a_kilogram(), leaning(2, 0.6)), "3 orientations are too few, expected"},
      {samples_of(half_a_kilogram(), leaning(5, 0.05)), "too much alike"},
      {reversed, "the sensor's sign is reversed"},
      {touched, "touched something or moved"},
      {samples_of(heavy, leaning(5, 0.6)), "30.00 kg are no payload for this arm"}};
  int i = 0;
  for (const auto& [samples, what] : cases) {
    const std::string csv =
        folder.write(std::to_string(++i) + ".csv", payload_samples_text(samples));
    const std::string block = folder.path() + "/payload.conf";
    const CalibrateRun run({"--from", csv, "--out", block, "--json"});
    EXPECT_EQ(run.code, kExitRefused) << what;
    EXPECT_NE(run.err.find(what), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(block)) << what;
  }
}

TEST(Calibrate, UsageErrorsExitWithTwoAndOneLine) {
  const TempFolder folder;
  const std::string csv =
      folder.write("a.csv", payload_samples_text(samples_of(half_a_kilogram(), leaning(5, 0.6))));
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"--poses", "3"}, "--poses: '3': expected a number from 4 to 50 orientations"},
      {{"--poses", "4.5"}, "--poses: '4.5': expected a whole number"},
      {{"--poses", "6", "--from", csv}, "--poses is for a running arm, not for --from"},
      {{"--from", "/nowhere/a.csv"}, "/nowhere/a.csv: cannot open: No such file or directory"},
      {{"--from", csv, "--out", csv}, "--out: " + csv + " is there already, expected a new file"},
      {{"--from", csv, "--record", csv},
       "--record: " + csv + " is there already, expected a new file"},
      {{"--from", csv, "--out", "/nowhere/x/p"},
       "/nowhere/x/p: cannot write: No such file or directory"}};
  for (const auto& [args, what] : cases) {
    const CalibrateRun run(args);
    EXPECT_EQ(run.code, kExitUsage) << what;
    EXPECT_EQ(run.err, "handrail: " + what + '\n');
    EXPECT_EQ(run.out, "");
  }
}

TEST(Calibrate, WithoutAMasterExitsWithThree) {
  const CalibrateRun run({"--socket", "/nowhere/operator.sock"});
  EXPECT_EQ(run.code, kExitNoMaster);
  EXPECT_EQ(
      run.err,
      "handrail: no master on /nowhere/operator.sock: no such socket; start handrail-master\n");
}

TEST(PayloadSamples, BadFilesAreNamedByLineAndColumn) {
  const std::string good = "1,0,0,0,1,2,3,4,5,6\n";
  EXPECT_EQ(error_in(kHeader + good + "\r\n"), "");
  EXPECT_EQ(error_in("\n  \n").substr(0, 51),
            "a.csv:1:1: the file is empty, expected the header q");
  EXPECT_EQ(error_in("qw,qx,qz\n").substr(0, 47),
            "a.csv:1:7: the header says 'qz', expected qy of");
  EXPECT_EQ(error_in("qw,qx\n").substr(0, 56),
            "a.csv:1:1: the header has 2 columns, expected 10 or 12: ");
  EXPECT_EQ(error_in(kHeader + good + "1,0,0,0,1,2,3,4,5\n"),
            "a.csv:3:1: 9 values, expected 10 as in the header");
  EXPECT_EQ(error_in(kHeader + std::string("1,0,0,0, 1, x,3,4,5,6\n")),
            "a.csv:2:13: fy_n is 'x', expected a number from -1e6 to 1e6");
  for (const char* bad : {"nan", "inf", "2e6", "1.2.3", "", "0x1"}) {
    EXPECT_EQ(error_in(kHeader + ("1,0,0,0," + std::string(bad) + ",2,3,4,5,6")),
              "a.csv:2:9: fx_n is '" + std::string(bad) + "', expected a number from -1e6 to 1e6");
  }
  EXPECT_EQ(error_in(kHeader + std::string("1,1,0,0,1,2,3,4,5,6\n")),
            "a.csv:2:1: qw,qx,qy,qz has length 1.41, expected 1");
  const std::string with_noise =
      std::string(kHeader, sizeof kHeader - 2) + ",force_noise_n,torque_noise_n_m\n";
  EXPECT_EQ(error_in(with_noise + "1,0,0,0,1,2,3,4,5,6,0.1,-1\n"),
            "a.csv:2:25: torque_noise_n_m is '-1', expected a number from 0 to 1e6");
}

}  // namespace
}  // namespace handrail
