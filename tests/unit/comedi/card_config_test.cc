// Devices at a card, from a daemon's file to a driver and back.
#include <gmock/gmock.h>

#include "devices/comedi/comedi_ft_driver.h"
#include "devices/comedi/comedi_joystick_driver.h"
#include "devices/config/device_config_io.h"
#include "server/scene/config_io.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/comedi/comedi_bench.h"

namespace handrail {
namespace {

using test::ComediState;
using ::testing::HasSubstr;

class CardConfigTest : public test::ComediBench {
 protected:
  void SetUp() override {
    ComediBench::SetUp();
    card([](ComediState& s) { s.subdevices = multi(); });
  }
  std::string master_error(const std::string& text) {
    return load_master_config(folder.write("m.conf", "device { " + text + " }"), "", "").message();
  }
  std::string slave_error(const std::string& text) {
    return load_slave_config(folder.write("s.conf", "force_sensor { " + text + " }"), "").message();
  }
  ComediJoystickOptions joystick(const std::string& block) {
    const auto config = load_master_config(folder.write("m.conf", block), "", "");
    EXPECT_TRUE(config) << config.message();
    return haptic_options(config->device()).joystick;
  }
  ComediFtOptions sensor(const std::string& block) {
    const auto config = load_slave_config(folder.write("s.conf", block), "");
    EXPECT_TRUE(config) << config.message();
    return comedi_sensor_options(config->force_sensor());
  }
  std::string library() const { return "library: \"" + place.library + "\" "; }
  TempFolder folder;
};

TEST_F(CardConfigTest, WhatAJoysticksBlockSaysIsWhatItsDriverWritesAgain) {
  const std::string block =
      "device { kind: JOYSTICK joystick { " + library() +
      "board: \"jr3_pci_1\" encoder_subdevice: [3, 3] encoder_channel: [1, 2] setup: NI_X4 "
      "counts_per_turn: [-8000, 10000] torque_subdevice: 1 torque_channel: [2, 3] volts_per_n_m: "
      "[2, -3.5] most_force_n: 12 homing: CENTRE button_subdevice: 2 button_channel: [4, 5] "
      "button_low: false travel_mm: 210 } }";
  const ComediJoystickOptions o = joystick(block);
  EXPECT_EQ(o.place.board, "jr3_pci_1");
  EXPECT_EQ(*o.encoder_subdevice[1], 3u);
  EXPECT_EQ(o.encoder_channel, (std::array<unsigned int, 2>{1, 2}));
  EXPECT_EQ(o.setup, EncoderSetup::kNiX4);
  EXPECT_EQ(o.counts_per_turn, (std::array<double, 2>{-8000.0, 10000.0}));
  EXPECT_EQ(*o.torque_subdevice, 1u);
  EXPECT_EQ(o.torque_channel, (std::array<unsigned int, 2>{2, 3}));
  EXPECT_EQ(o.volts_per_n_m, (std::array<double, 2>{2.0, -3.5}));
  EXPECT_EQ(o.most_force, 12.0);
  EXPECT_EQ(o.homing, StickHoming::kCentre);
  EXPECT_NEAR(o.travel, 0.21, 1e-12);
  EXPECT_EQ(o.button_channels, (std::vector<unsigned int>{4, 5}));
  EXPECT_FALSE(o.button_low);
  const auto test = ComediJoystickDriver(o).test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  EXPECT_EQ((*test)->block(), block);
  // Nothing said: the dissertation's.
  const ComediJoystickOptions usual = joystick("device { kind: JOYSTICK }");
  EXPECT_EQ(usual.place.device, "/dev/comedi0");
  EXPECT_EQ(usual.counts_per_turn, ComediJoystickOptions().counts_per_turn);
  EXPECT_EQ(usual.volts_per_n_m, ComediJoystickOptions().volts_per_n_m);
  EXPECT_EQ(usual.most_force, kJoystickPeakForce);
  EXPECT_EQ(usual.homing, StickHoming::kStops);
}

TEST_F(CardConfigTest, WhatASensorsBlockSaysIsWhatItsDriverWritesAgain) {
  std::string matrix = "matrix: [";
  for (int i = 0; i < 36; ++i) matrix += (i == 0 ? "" : ", ") + std::to_string(i + 1);
  const std::string block =
      "force_sensor { comedi { " + library() +
      "subdevice: 0 rate_hz: 500 kind: ANALOG channel: [7, 6, 5, 4, 3, 2] reference: GROUND " +
      matrix +
      "] bias_v: [0.5, 0, 0, 0, 0, -1] } mount { turn_deg: [0, 0, 90] offset_mm: [1, 2, -3] } "
      "range_n: 150 }";
  const ComediFtOptions o = sensor(block);
  EXPECT_EQ(o.kind, ComediFtKind::kAnalog);
  EXPECT_EQ(o.channels, (std::array<unsigned int, 6>{7, 6, 5, 4, 3, 2}));
  EXPECT_EQ(o.reference, 0u);
  EXPECT_EQ(o.matrix(0, 1), 2.0);  // row by row
  EXPECT_EQ(o.matrix(5, 0), 31.0);
  EXPECT_EQ(o.bias[5], -1.0);
  EXPECT_EQ(o.range_n, 150.0);
  EXPECT_TRUE(o.mount.X_TF.p.isApprox(Vec3(0.001, 0.002, -0.003), 1e-12));
  EXPECT_TRUE((o.mount.X_TF.q * Vec3::UnitX()).isApprox(Vec3::UnitY(), 1e-12));
  const auto test = ComediFtDriver(o).test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  EXPECT_EQ((*test)->block(), block);
  const ComediFtOptions jr3 =
      sensor("force_sensor { comedi { filter: 3 device: '/dev/comedi1' } }");
  EXPECT_EQ(jr3.kind, ComediFtKind::kJr3);
  EXPECT_EQ(jr3.filter, 3u);
  EXPECT_EQ(jr3.place.device, "/dev/comedi1");
  EXPECT_EQ(jr3.rate, 1000.0);
}

TEST_F(CardConfigTest, ASensorOnTheNetworkHasTheMountToo) {
  const auto config = load_slave_config(
      folder.write("s.conf",
                   "force_sensor { mount { offset_mm: [1, 2, -184] turn_deg: [0, 180, 0] } }"),
      "");
  ASSERT_TRUE(config) << config.message();
  const Pose mount = sensor_options(config->force_sensor()).mount.X_TF;
  EXPECT_TRUE(mount.p.isApprox(Vec3(0.001, 0.002, -0.184), 1e-12));
  EXPECT_TRUE((mount.q * Vec3::UnitX()).isApprox(-Vec3::UnitX(), 1e-9));
  EXPECT_TRUE((mount.q * Vec3::UnitY()).isApprox(Vec3::UnitY(), 1e-9));
}

TEST_F(CardConfigTest, ALibraryWithASlashIsFoundFromTheFilesFolderOn) {
  EXPECT_EQ(joystick("device { kind: JOYSTICK joystick { library: 'x/lib.so' } }").place.library,
            folder.path() + "/x/lib.so");
  EXPECT_EQ(joystick("device { kind: JOYSTICK joystick { library: 'lib.so' } }").place.library,
            "lib.so");
  EXPECT_EQ(sensor("force_sensor { comedi { library: './lib.so' } }").place.library,
            folder.path() + "/./lib.so");
}

TEST_F(CardConfigTest, WhatAJoystickCannotBeIsNamed) {
  EXPECT_THAT(master_error("joystick {}"),
              HasSubstr("field 'device.joystick': only used with kind: JOYSTICK"));
  const auto error = [&](const std::string& inner) {
    return master_error("kind: JOYSTICK joystick { " + inner + " }");
  };
  EXPECT_EQ(error("device: '/dev/comedi7'"), "");
  EXPECT_THAT(error("device: 'comedi0'"), HasSubstr("joystick.device': 'comedi0', expected the "
                                                    "path of a device of comedi"));
  EXPECT_THAT(error("library: ''"), HasSubstr("joystick.library': empty"));
  EXPECT_THAT(error("counts_per_turn: [10000, 0]"),
              HasSubstr("counts_per_turn[1]': 0, expected 1000 or more"));
  EXPECT_THAT(error("counts_per_turn: [1]"), HasSubstr("counts_per_turn"));
  EXPECT_THAT(error("volts_per_n_m: [0.001, 1]"), HasSubstr("volts_per_n_m[0]': 0.001, expected"));
  EXPECT_THAT(error("torque_channel: [1, 1]"), HasSubstr("torque_channel[1]': 1 is there already"));
  EXPECT_THAT(error("encoder_channel: [0, 0]"), HasSubstr("encoder_channel[1]'"));
  EXPECT_EQ(error("encoder_subdevice: [11, 12] encoder_channel: [0, 0]"), "");
  EXPECT_THAT(error("button_channel: [0, 1, 2, 3]"), HasSubstr("4 channels, expected at most 3"));
  EXPECT_THAT(error("most_force_n: 26"), HasSubstr("26 is outside 0.5 to 25.3 N"));
}

TEST_F(CardConfigTest, WhatASensorAtACardCannotBeIsNamed) {
  EXPECT_EQ(slave_error("comedi {}"), "");
  EXPECT_THAT(
      slave_error("comedi {} address: '10.0.0.1'"),
      HasSubstr("force_sensor.address': is for a sensor on the network, but comedi is one"));
  EXPECT_THAT(slave_error("comedi {} dialect: ONROBOT"), HasSubstr("force_sensor.dialect'"));
  EXPECT_THAT(slave_error("comedi { device: 'x' }"), HasSubstr("comedi.device': 'x', expected"));
  EXPECT_THAT(slave_error("comedi { kind: ANALOG }"),
              HasSubstr("comedi.matrix': missing, but kind ANALOG needs the 36 numbers"));
  EXPECT_THAT(slave_error("comedi { matrix: [1, 2] }"), HasSubstr("expected 36"));
  std::string zero_row = "comedi { kind: ANALOG matrix: [";
  for (int i = 0; i < 36; ++i) zero_row += std::string(i == 0 ? "" : ",") + (i < 30 ? "1" : "0");
  EXPECT_THAT(slave_error(zero_row + "] }"), HasSubstr("row 5 (of 0 to 5) is all 0"));
  EXPECT_THAT(slave_error(zero_row + "] filter: 1 }"), HasSubstr("filter': only used with kind: "
                                                                 "JR3"));
  EXPECT_THAT(slave_error("comedi { input_range: 1 }"), HasSubstr("only used with kind: ANALOG"));
  EXPECT_THAT(slave_error("comedi { filter: 7 }"), HasSubstr("7 is outside 0 to 6"));
  EXPECT_THAT(slave_error("mount { turn_deg: [150, 150, 0] }"),
              HasSubstr("force_sensor.mount.turn_deg': 212.1 deg long, expected at most 180"));
  EXPECT_THAT(slave_error("mount { turn_deg: [150, 0, 150] }"), HasSubstr("212.1 deg long"));
  EXPECT_THAT(slave_error("mount { turn_deg: [0, 180, 1] }"), HasSubstr("180 deg long"));
}

// The sensor's own trial and calibrations.
class ComediFtDriverTest : public CardConfigTest {
 protected:
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    return {"", Verdict::kNotSeen, "", ""};
  }
  void run(StartedTest started) {
    ASSERT_TRUE(started) << started.message();
    test = std::move(*started);
    for (int i = 0; i < 20'000 && test->turn(monotonic_now()); ++i) {
      sleep_until(monotonic_now() + kMillisecond);
    }
  }
  void TearDown() override {
    test.reset();
    CardConfigTest::TearDown();
  }
  ComediFtOptions options() {
    ComediFtOptions out;
    out.place = place;
    return out;
  }
  std::unique_ptr<SelfTest> test;
};

TEST_F(ComediFtDriverTest, ProbesSayWhatIsThereAndWhatIsMissing) {
  card([](ComediState& s) { s.subdevices = {jr3()}; });
  ComediFtOptions o = options();
  o.filter = 0;
  std::vector<Sighting> seen = ComediFtDriver(o).probe();
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[1].readiness, Readiness::kReady);
  EXPECT_THAT(seen[1].fact, HasSubstr("jr3_pci_1, full scale 200, 200, 400 N"));
  card([](ComediState& s) { s.read_error = EAGAIN; });
  seen = ComediFtDriver(o).probe();
  EXPECT_EQ(seen[1].readiness, Readiness::kUnfinished);
  EXPECT_THAT(seen[1].fact, HasSubstr("it gives no readings yet: a sensor takes 12 s"));
  card([](ComediState& s) { s.driver = "s626"; });
  seen = ComediFtDriver(o).probe();
  EXPECT_EQ(seen[1].fact, "is 'jr3_pci_1', driven by s626, expected one of jr3_pci");
  EXPECT_THAT(seen[1].next, HasSubstr("name the card of JR3"));
}

TEST_F(ComediFtDriverTest, ATestWaitsForTheSensorAndThenLooksAtIt) {
  card([](ComediState& s) { s.subdevices = {jr3()}; });
  ComediFtOptions o = options();
  o.filter = 4;
  ASSERT_NO_FATAL_FAILURE(run(ComediFtDriver(o).test({.alone = true})));
  EXPECT_EQ(item("card").verdict, Verdict::kOk);
  EXPECT_THAT(item("card").fact, HasSubstr("readings come"));
  EXPECT_EQ(item("status").verdict, Verdict::kOk) << item("status").fact;
}

TEST_F(ComediFtDriverTest, CalibrationTakesTheFullScaleOfAJr3) {
  card([](ComediState& s) { s.subdevices = {jr3()}; });
  ASSERT_NO_FATAL_FAILURE(run(ComediFtDriver(options()).calibrate()));
  EXPECT_EQ(item("scale").verdict, Verdict::kOk);
  EXPECT_THAT(test->block(), HasSubstr("range_n: 200 }"));
}

TEST_F(ComediFtDriverTest, CalibrationTakesSixVoltagesWithoutAForce) {
  card([](ComediState& s) { s.subdevices[0].values[2] = 36045; });  // 1.00023 V
  ComediFtOptions o = options();
  o.kind = ComediFtKind::kAnalog;
  o.matrix.setConstant(3.0);
  o.bias.setConstant(9.0);
  o.mount.X_TF.p = Vec3(1.0, 0.0, 0.0);
  ASSERT_NO_FATAL_FAILURE(run(ComediFtDriver(o).calibrate()));
  EXPECT_EQ(item("bias").verdict, Verdict::kOk) << item("bias").fact;
  const ComediFtOptions again = sensor(test->block());
  EXPECT_NEAR(again.bias[2], 1.00023, 2e-5);
  EXPECT_NEAR(again.bias[0], 0.00015, 2e-5);
  EXPECT_EQ(again.matrix(3, 3), 3.0);
}

}  // namespace
}  // namespace handrail
