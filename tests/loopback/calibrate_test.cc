// A payload found with the real programs, and taken out by them.
#include <gmock/gmock.h>

#include "server/scene/config_io.h"
#include "server/scene/payload_io.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/pseudo_terminal.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// The rig carries half a kilogram, and its sensor has a zero.
class CalibrateTest : public WholeCell {
 protected:
  void SetUp() override {
    folder.write("loaded.scene",
                 "name: 'loaded' simulate { effect { servo_lag {} } effect { sensor_noise {} }"
                 "  effect { gravity_sag { payload_kg: 0.5 centre_mm: [4, -2, 60] } }"
                 "  effect { sensor_drift { n_per_s: 0 start_n: [1.5, -2, 0.7] } } }");
    rig_extra = "scene: 'loaded' scene_path: '" + folder.path() + "'";
    WholeCell::SetUp();
  }
  void tilt(const std::string& by_deg) {
    order("hand { rotation_deg: [" + by_deg + "] duration_s: 0.5 }");
  }
  static double force(const pb::Status& s) {
    const auto& f = s.contact_force_n();
    return f.size() == 3 ? Vec3(f[0], f[1], f[2]).norm() : -1.0;
  }
};

TEST_F(CalibrateTest, SixTiltsOfTheTipGiveThePayloadAndItsBlockTakesItOut) {
  const std::string block = folder.path() + "/payload.conf", csv = folder.path() + "/samples.csv";
  order("engage: true");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return force(s) > 4.0; })) << "in free air";
  Program calibrate(
      folder, "handrail",
      {"calibrate", "payload", "--socket", socket(), "--out", block, "--record", csv});
  (void)calibrate.after("1 of 6: the sensor reads ");
  int taken = 1;
  for (const char* by : {"25, 0, 0", "-50, 0, 0", "25, 0, 25", "0, 0, -50", "30, 0, 55"}) {
    tilt(by);
    (void)calibrate.after(std::to_string(++taken) + " of 6: ");
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(calibrate.finish(), 0) << calibrate.output();
  const Result<pb::SlaveConfig> config = load_slave_config(block);
  ASSERT_TRUE(config.is_ok()) << config.message();
  const Payload found = payload_from(config->payload());
  EXPECT_NEAR(found.mass, 0.5, 0.01);
  EXPECT_LT((found.centre_T - Vec3(0.004, -0.002, 0.06)).norm(), 2e-3);
  EXPECT_LT((found.bias_T.force - Vec3(1.5, -2.0, 0.7)).norm(), 0.1);
  const auto again = handrail({"calibrate", "payload", "--from", csv});
  EXPECT_EQ(again.first, 0);
  EXPECT_THAT(again.second, HasSubstr(payload_text(found)));

  slave.reset();
  slave_extra = payload_text(found);
  start_slave();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.payload_removed(); }));
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.has_contact_force(); }));
  EXPECT_LT(force(status()), 0.5);
  const auto refused = handrail({"calibrate", "payload"});
  EXPECT_EQ(refused.first, 1);
  EXPECT_THAT(refused.second, HasSubstr("already takes a payload out of its readings"));
}

// On a terminal, live.
TEST_F(CalibrateTest, SaysWhyAPoseDoesNotCount) {
  order("engage: true");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return force(s) > 4.0; })) << "in free air";
  PseudoTerminal terminal;
  ASSERT_TRUE(terminal.works());
  streams.error = terminal.program();
  Program calibrate(folder, "handrail", {"calibrate", "payload", "--socket", socket()}, streams);
  const auto shows = [&](const std::string& part) {
    return !terminal.shown_until(part, 1, kPatience).empty();
  };
  EXPECT_TRUE(shows(" deg from the nearest sample, expected 20; tilt on"));
  // Far enough tilted, and still on its way.
  order("hand { rotation_deg: [45, 0, 0] duration_s: 2 }");
  EXPECT_TRUE(shows("does not count: moved by "));
  calibrate.send(SIGINT);
  EXPECT_EQ(calibrate.finish(), 130);
}

TEST_F(CalibrateTest, CtrlCEndsItAndWhatWasGatheredIsKept) {
  const std::string block = folder.path() + "/payload.conf", csv = folder.path() + "/samples.csv";
  Program calibrate(
      folder, "handrail",
      {"calibrate", "payload", "--socket", socket(), "--out", block, "--record", csv});
  (void)calibrate.after("1 of 6: ");
  calibrate.send(SIGINT);
  EXPECT_EQ(calibrate.finish(), 130);
  EXPECT_THAT(calibrate.output(), HasSubstr("stopped after 1 of 6 orientations\nkept in " + csv));
  EXPECT_TRUE(std::filesystem::exists(csv));
  EXPECT_FALSE(std::filesystem::exists(block));
}

}  // namespace
}  // namespace handrail
