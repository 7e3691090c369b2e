// What the judge is told: lateness, the wire's truth, ways of the tip.
#include <gmock/gmock.h>

#include <cmath>

#include "devices/rig/servo_arm.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/kinematics/rv2a.h"
#include "tests/emulator/ip_packet.h"
#include "tests/emulator/tap.h"
#include "tests/faults/arm_path.h"
#include "tests/faults/forged.h"
#include "tests/faults/lateness.h"
#include "tests/faults/wire_truth.h"
#include "tests/support/temp_folder.h"

namespace handrail::faults {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(Lateness, TheWorstOfASpanIsOfThoseWhoWaitedInIt) {
  const LatenessLog log({{20, 5}, {10, 3}, {100, 50}});
  EXPECT_EQ(log.worst(), 50);
  EXPECT_EQ(log.worst(0, 9), 0);
  EXPECT_EQ(log.worst(0, 10), 3);
  EXPECT_EQ(log.worst(12, 13), 3);  // it was still waiting
  EXPECT_EQ(log.worst(14, 19), 0);
  EXPECT_EQ(log.worst(14, 20), 5);
  EXPECT_EQ(log.worst(149, 200), 50);
  EXPECT_EQ(log.worst(151, 200), 0);
}

TEST(Lateness, AProbeFindsAThreadThatIsKeptWaiting) {
  LatenessProbe probe;
  sleep_until(monotonic_now() + 20 * kMillisecond);
  const LatenessLog log = probe.finish();
  EXPECT_LT(log.worst(), kSecond);
}

// Two taps of a link: what is written here arrives there as the test says.
class WireTruthTest : public ::testing::Test {
 protected:
  Bytes packet(bool to_slave, std::uint8_t type, std::size_t size = 100) {
    const auto near = *emulator::read_endpoint("10.77.0.1:5000");
    const auto far = *emulator::read_endpoint("10.77.0.2:47002");
    const Bytes record = record_of(type, 0, Bytes(size));
    return to_slave ? emulator::make_udp(near, far, record) : emulator::make_udp(far, near, record);
  }
  void write() {
    auto near_tap = emulator::Tap::open(folder.path() + "/near.pcap", kTapBytes);
    auto far_tap = emulator::Tap::open(folder.path() + "/far.pcap", kTapBytes);
    ASSERT_TRUE(near_tap && far_tap);
    near_tap->sent(packet(true, 22), 1, 10);
    for (std::uint64_t n = 2; n <= 6; ++n) {
      near_tap->sent(packet(true, 23), n, static_cast<Nanos>(10 * n));
    }
    far_tap->delivered(packet(true, 22), 1, Origin::kGenuine, 11);
    far_tap->delivered(packet(true, 23), 2, Origin::kGenuine, 21);
    far_tap->delivered(packet(true, 23), 4, Origin::kGenuine, 41);
    far_tap->delivered(packet(true, 23), 3, Origin::kGenuine, 45);    // overtaken
    far_tap->delivered(packet(true, 23), 4, Origin::kDuplicate, 46);  // again
    far_tap->delivered(packet(true, 23), 5, Origin::kCorrupt, 51);    // never genuine
    far_tap->delivered(packet(true, 23), 6, Origin::kDuplicate, 61);  // before its original
    far_tap->delivered(packet(true, 23), 6, Origin::kGenuine, 62);
    far_tap->delivered(packet(true, 23), 2, Origin::kReplay, 70);
    far_tap->delivered(packet(true, 23), 0, Origin::kInjected, 71);
    far_tap->sent(packet(false, 23, 500), 1, 80);
    near_tap->delivered(packet(false, 23, 500), 2, Origin::kGenuine, 85);
    near_tap->delivered(packet(false, 23), 3, Origin::kReplay, 86);
    near_tap->delivered(packet(false, 22), 4, Origin::kGenuine, 87);
    near_tap->delivered(packet(false, 23), 1, Origin::kGenuine, 88);    // overtaken
    near_tap->delivered(packet(false, 23), 5, Origin::kDuplicate, 90);  // before its original
    near_tap->delivered(packet(false, 23), 5, Origin::kGenuine, 95);
    ASSERT_TRUE(near_tap->close() && far_tap->close());
  }
  TempFolder folder;
};

TEST_F(WireTruthTest, OnlyTheNewestGenuineStatesAreFresh) {
  write();
  const auto truth = read_truth(folder.path());
  ASSERT_TRUE(truth.is_ok()) << truth.message();
  ASSERT_THAT(truth->to_slave, SizeIs(3));
  EXPECT_EQ(truth->to_slave[0].sent, 20);
  EXPECT_EQ(truth->to_slave[0].at, 21);
  EXPECT_EQ(truth->to_slave[1].number, 4u);
  EXPECT_EQ(truth->to_slave[2].at, 61) << "a copy that came first";
  EXPECT_THAT(truth->to_master, ElementsAre(85, 90)) << "and here";
  EXPECT_EQ(truth->overtaken, 2u);
  EXPECT_EQ(truth->delivered(Origin::kDuplicate), 2u);
  EXPECT_EQ(truth->delivered(Origin::kReplay), 1u);
  EXPECT_EQ(truth->delivered(Origin::kCorrupt), 1u);
  EXPECT_EQ(truth->delivered(Origin::kInjected), 1u);
  EXPECT_EQ(truth->longest, 13u + 500u) << "also of packets that the tap cut";
}

TEST_F(WireTruthTest, ATapThatIsNotThereIsNamed) {
  const auto truth = read_truth(folder.path());
  ASSERT_FALSE(truth.is_ok());
  EXPECT_NE(truth.message().find("near.pcap"), std::string::npos);
}

TEST(ArmPath, AStepBackIsMeasuredAlongTheWay) {
  std::vector<TipAt> way;
  for (const double x : {0.0, 0.01, 0.02, 0.017, 0.03}) way.push_back({0, Vec3(x, 0.0, 0.0)});
  EXPECT_NEAR(backward(way), 0.003, 1e-12);
  way.erase(way.begin() + 3);
  EXPECT_EQ(backward(way), 0.0);
  EXPECT_EQ(backward({}), 0.0);
  EXPECT_EQ(backward({{0, Vec3::Zero()}, {1, Vec3::Zero()}}), 0.0);
}

TEST(ArmPath, TheTrackingErrorIsToWhatWasAskedAtThatTime) {
  const std::vector<TipAt> way = {{0, Vec3::Zero()}, {100, Vec3(0.1, 0.0, 0.0)}};
  EXPECT_NEAR(tracking_error(way, {{50, Vec3(0.05, 0.003, 0.0)}}), 0.003, 1e-12);
  EXPECT_NEAR(tracking_error(way, {{50, Vec3(0.05, 0.003, 0.0)}, {75, Vec3(0.075, 0.0, 0.0)}}),
              0.003 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(tracking_error(way, {{200, Vec3::Zero()}}), 0.0) << "nothing to compare";
}

TEST(ArmPath, TheTipIsThatOfTheTargets) {
  TapFile tap;
  TapRecord r;
  r.at = 5;
  const JointVector q = ServoArmOptions::default_start();
  std::copy_n(q.data(), kJoints, r.target.begin());
  tap.records = {r};
  const auto tips = tips_of(tap, 0, 10);
  ASSERT_THAT(tips, SizeIs(1));
  EXPECT_NEAR((tips[0].p - forward(ArmGeometry(), q).p).norm(), 0.0, 1e-12);
  EXPECT_THAT(tips_of(tap, 6, 10), SizeIs(0));
}

}  // namespace
}  // namespace handrail::faults
