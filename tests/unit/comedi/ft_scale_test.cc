// Forces from counts and from volts: reckoned by hand from what the kernel's drivers do.
#include "devices/comedi/ft_scale.h"

#include <gtest/gtest.h>

#include <numbers>

#include "devices/ft_mount.h"

namespace handrail {
namespace {

TEST(FtScale, ChannelsOfAJr3AreEightAFilter) {
  EXPECT_EQ(jr3_channel(0, 0), 0u);
  EXPECT_EQ(jr3_channel(1, 5), 13u);
  EXPECT_EQ(jr3_channel(6, 2), 50u);
}

// jr3_pci: a sensor of 200 N tells full_scale.fx = 200, and the range is -200*1000 to 200*1000
// millionths, so 0.2; one of 12 N m tells 120 (N m times ten) and -120*100 to 120*100, so 0.012.
TEST(FtScale, AFullScaleIsTheRangeInThousands) {
  EXPECT_DOUBLE_EQ(jr3_full_scale({-200 * 1000 * 1e-6, 200 * 1000 * 1e-6, 2}), 200.0);
  EXPECT_DOUBLE_EQ(jr3_full_scale({-120 * 100 * 1e-6, 120 * 100 * 1e-6, 2}), 12.0);
}

TEST(FtScale, SixteenThousandThreeHundredEightyFourCountsAreFullScale) {
  FtSix full;
  full << 200.0, 200.0, 400.0, 12.0, 12.0, 10.0;
  // 0x4000 is none; 8192 counts more are half, 4096 less a quarter the other way.
  const FtReading r = jr3_reading({16384, 24576, 12288, 16385, 0x4000, 16384 - 1638}, full);
  EXPECT_EQ(r.saturated, 0u);
  EXPECT_DOUBLE_EQ(r.value[0], 0.0);
  EXPECT_DOUBLE_EQ(r.value[1], 100.0);
  EXPECT_DOUBLE_EQ(r.value[2], -100.0);
  EXPECT_DOUBLE_EQ(r.value[3], 12.0 / 16384.0);
  EXPECT_NEAR(r.value[5], -1.0, 1e-3);
}

TEST(FtScale, AnAxisAtItsEndIsSaid) {
  const FtSix full = FtSix::Constant(100.0);
  EXPECT_EQ(jr3_reading({32767, 16384, 16384, 16384, 16384, 16384}, full).saturated, 1u);
  EXPECT_EQ(jr3_reading({16384, 1, 16384, 16384, 16384, 16384}, full).saturated, 2u);
  EXPECT_EQ(jr3_reading({16384, 16384, 32766, 2, 16384, 16384}, full).saturated, 0u);
  // -20000 + 0x4000, as the kernel's driver adds it, without looking.
  const FtReading wrapped = jr3_reading({16384, 16384, 16384, 16384, 16384, 0xfffff1e0u}, full);
  EXPECT_EQ(wrapped.saturated, 0x20u);
  EXPECT_NEAR(wrapped.value[5], -100.0 * 20000.0 / 16384.0, 1e-9);
}

TEST(FtScale, VoltsAreTheRangeDividedByTheLargestNumber) {
  const ComediRange ten{-10.0, 10.0, 0};
  EXPECT_DOUBLE_EQ(comedi_value(0, ten, 65535), -10.0);
  EXPECT_DOUBLE_EQ(comedi_value(65535, ten, 65535), 10.0);
  EXPECT_NEAR(comedi_value(32768, ten, 65535), 10.0 / 65535.0, 1e-12);
  EXPECT_EQ(comedi_number(0.0, ten, 65535), 32768u);
  EXPECT_EQ(comedi_number(5.0, ten, 65535), 49151u);
  EXPECT_EQ(comedi_number(-10.0, ten, 65535), 0u);
  EXPECT_EQ(comedi_number(99.0, ten, 65535), 65535u);
  EXPECT_EQ(comedi_number(-99.0, ten, 65535), 0u);
  EXPECT_EQ(comedi_number(std::nan(""), ten, 65535), 0u);
}

TEST(FtScale, SixVoltagesAreTheMatrixTimesWhatTheyAreAboveTheBias) {
  FtMatrix matrix = FtMatrix::Zero();
  matrix(0, 0) = 20.0;  // [N/V]
  matrix(0, 1) = -2.0;  // crosstalk
  matrix(5, 3) = 1.5;   // [N m/V]
  FtSix bias = FtSix::Zero(), volts = FtSix::Zero();
  bias[0] = 0.5;
  volts << 2.5, 1.0, 0.0, -2.0, 0.0, 0.0;
  const FtReading r = analog_reading(volts, 0, bias, matrix);
  EXPECT_DOUBLE_EQ(r.value[0], 20.0 * 2.0 - 2.0 * 1.0);
  EXPECT_DOUBLE_EQ(r.value[5], -3.0);
  EXPECT_EQ(r.saturated, 0u);
  EXPECT_EQ(analog_reading(volts, 4, bias, matrix).saturated, 0x3fu);
}

// A sensor turned by a quarter about the tool, 30 mm behind the tip: what it feels along its x is
// along y, and makes 0.03 m times as much about x.
TEST(FtScale, AMountTurnsTheWrenchAndMovesItToTheTip) {
  const FtMount mount{
      {Vec3(0.0, 0.0, -0.03), rotation_exp(Vec3(0.0, 0.0, std::numbers::pi / 2.0))}};
  const Wrench at = at_tip(mount, {Vec3(10.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0)});
  EXPECT_TRUE(at.force.isApprox(Vec3(0.0, 10.0, 0.0), 1e-12));
  // (0, 0, -0.03) x (0, 10, 0) = (0.3, 0, 0); its own (0, 1, 0) is turned to (-1, 0, 0).
  EXPECT_TRUE(at.torque.isApprox(Vec3(-0.7, 0.0, 0.0), 1e-12));
  EXPECT_EQ(mount_block(mount), "mount { turn_deg: [0, 0, 90] offset_mm: [0, 0, -30] } ");
  EXPECT_EQ(mount_block({}), "");
}

// Turned about no axis of its own: x is the flange's y, y its z, z its x.
TEST(FtScale, AMountsLeverIsInTheFlangesAxesAndItsWrenchInTheSensors) {
  const FtMount mount{{Vec3(0.01, 0.02, -0.03), Quat(0.5, 0.5, 0.5, 0.5)}};
  const Wrench at = at_tip(mount, {Vec3(10.0, 20.0, 30.0), Vec3(1.0, 2.0, 3.0)});
  EXPECT_TRUE(at.force.isApprox(Vec3(30.0, 10.0, 20.0), 1e-12));
  // (0.01, 0.02, -0.03) x (30, 10, 20) = (0.7, -1.1, -0.5), beside (3, 1, 2).
  EXPECT_TRUE(at.torque.isApprox(Vec3(3.7, -0.1, 1.5), 1e-12));
  EXPECT_EQ(mount_block(mount),
            "mount { turn_deg: [69.282032, 69.282032, 69.282032] offset_mm: [10, 20, -30] } ");
  EXPECT_EQ(mount_block({{Vec3::Zero(), mount.X_TF.q}}),
            "mount { turn_deg: [69.282032, 69.282032, 69.282032] } ");
  EXPECT_EQ(mount_block({{Vec3(0.0, 0.0, 1e-3), Quat::Identity()}}),
            "mount { offset_mm: [0, 0, 1] } ");
  EXPECT_EQ(mount_block({{Vec3(1e-6, 0.0, 0.0), Quat::Identity()}}),
            "mount { offset_mm: [0.001, 0, 0] } ");
}

}  // namespace
}  // namespace handrail
