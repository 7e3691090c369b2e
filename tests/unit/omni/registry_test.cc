#include "devices/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Registry, MakesTheSimulatedDevices) {
  HapticDeviceOptions options;
  const auto plain = make_haptic_device(options);
  ASSERT_TRUE(plain.is_ok()) << plain.message();
  EXPECT_TRUE((*plain)->capabilities().simulated);
  EXPECT_FALSE((*plain)->capabilities().actuates_torque);
  EXPECT_NE((*plain)->hand(), nullptr);
  options.kind = HapticDeviceKind::kSimOmniTorque;
  EXPECT_TRUE((*make_haptic_device(options))->capabilities().actuates_torque);
}

TEST(Registry, HandsTheSeedOn) {
  const auto position = [](std::uint64_t seed) {
    HapticDeviceOptions options;
    options.hand.seed = seed;
    auto device = make_haptic_device(options);
    EXPECT_TRUE((*device)->open().is_ok());
    (*device)->read(0);
    return Vec3((*device)->read(kSecond).X_MH.p);
  };
  EXPECT_NE(position(1), position(2));
}

TEST(Registry, NamesAHandOptionThatMakesNoSense) {
  HapticDeviceOptions options;
  options.hand.mass = 0.0;
  EXPECT_THAT(make_haptic_device(options).message(),
              AllOf(HasSubstr("mass"), HasSubstr("expected a finite number > 0")));
  options.hand = HandOptions{};
  options.hand.stiffness = std::numeric_limits<double>::infinity();
  EXPECT_THAT(make_haptic_device(options).message(), HasSubstr("stiffness is inf"));
  options.hand = HandOptions{};
  options.hand.drift_rms = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(make_haptic_device(options).message(), HasSubstr("drift_rms is nan"));
}

TEST(Registry, NamesWhatIsWrongWithARecording) {
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kRecorded;
  EXPECT_THAT(make_haptic_device(options).message(), HasSubstr("recording is \"\""));
  const std::string path = ::testing::TempDir() + "registry_hand.csv";
  std::ofstream(path) << "t_s,x_mm,y_mm\n0,0,0\n1,zero,0\n";
  options.recording_path = path;
  EXPECT_THAT(make_haptic_device(options).message(),
              AllOf(HasSubstr(path + ":3: "), HasSubstr("\"zero\"")));
  std::remove(path.c_str());
}

TEST(Registry, RefusesAKindItDoesNotHave) {
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kCount;
  EXPECT_THAT(make_haptic_device(options).message(), HasSubstr("device kind"));
}

}  // namespace
}  // namespace handrail
