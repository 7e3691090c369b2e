// A gamepad and a wheel as umockdev recorded them at a real kernel's uinput, played back to the
// program as it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

constexpr char kPlayer[] = "/usr/bin/umockdev-run";

class RecordedByUmockdev : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "umockdev is preloaded, and a sanitizer wants to be first";
#endif
    if (::access(kPlayer, X_OK) != 0) {
      GTEST_SKIP() << kPlayer << " is not installed: client/install --tests";
    }
  }
  // What `handrail devices` says to a computer that has this device alone.
  std::string says(const std::string& device, std::vector<std::string> words, int code) {
    const std::string at = HANDRAIL_SOURCE_DIR "/tests/data/umockdev/" + device;
    const std::string program_file = HANDRAIL_BIN_DIR "/handrail";
    std::vector<std::string> all = {"-d",     at + ".umockdev",
                                    "-i",     "/dev/input/event1=" + at + ".ioctl",
                                    "-e",     "/dev/input/event1=" + at + ".events",
                                    "--",     program_file,
                                    "devices"};
    all.insert(all.end(), words.begin(), words.end());
    const TempFolder folder;
    Program program(folder, kPlayer, all);
    EXPECT_EQ(program.finish(), code) << program.output();
    return program.output();
  }
  TempFolder files;
  const std::string wheel = files.write(
      "m.conf",
      "device { kind: FORCE_STICK force_stick { device: '/dev/input/event1' axes: WHEEL "
      "full_force_n: [4, 0] } }");
};

TEST_F(RecordedByUmockdev, AGamepadIsFoundAndItsStickMovesTheHand) {
  EXPECT_THAT(says("pad", {"list"}, 0), HasSubstr("/dev/input/event1: Made-up pad, a gamepad"));
  const std::string tried = says("pad", {"test", "gamepad", "--alone"}, 1);
  EXPECT_THAT(tried, HasSubstr("0.0 % of them not valid"));
  // The stick goes right as it is played back, so it is not left alone.
  EXPECT_THAT(tried, HasSubstr("ok        rate"));
  EXPECT_THAT(tried, HasSubstr("BAD       still"));
}

TEST_F(RecordedByUmockdev, AWheelIsReadAndItsMotorsAreNotPlayedBack) {
  EXPECT_THAT(says("wheel", {"list", "--master-config", wheel}, 0),
              HasSubstr("Made-up wheel, takes constant forces; 65535 counts from end to end"));
  const std::string tried =
      says("wheel", {"test", "force-stick", "--alone", "--master-config", wheel}, 1);
  EXPECT_THAT(tried, HasSubstr("0.0 % of them not valid"));
  EXPECT_THAT(tried, HasSubstr("ok        rate"));
  EXPECT_THAT(tried, HasSubstr("NOT SEEN  uploads   none was made"));
  // umockdev 0.17 knows no EVIOCSFF: a device that takes no upload, and that is said.
  EXPECT_THAT(says("wheel", {"calibrate", "force-stick", "--master-config", wheel}, 1),
              HasSubstr("/dev/input/event1 did not take a constant force"));
}

}  // namespace
}  // namespace handrail
