// The real programs when one of them dies, freezes or is told nonsense.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <random>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/base/reason.h"
#include "tests/loopback/stopped_thread.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class CellFaultTest : public WholeCell {
 protected:
  // The operator's way back, once everything runs again.
  void reset_and_engage() {
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() < 20.0; }));
    if (status().state() == "fault" || status().slave_state() == "fault") order("reset: true");
    ASSERT_TRUE(eventually([this](const pb::Status& s) {
      return s.state() == "engaged" || ask("engage: true").done();
    }));
    EXPECT_TRUE(slave_reaches("engaged"));
  }
  // Random datagrams of many sizes, some that begin like real ones do.
  void send_garbage(int port, int count) {
    namespace asio = boost::asio;
    asio::io_context io;
    asio::ip::udp::socket sender(io, {asio::ip::make_address("127.0.0.1"), 0});
    const asio::ip::udp::endpoint to(asio::ip::make_address("127.0.0.1"),
                                     static_cast<unsigned short>(port));
    std::mt19937_64 dice(7);
    std::array<unsigned char, 2000> bytes{};
    for (int i = 0; i < count; ++i) {
      for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(dice());
      if (i % 2 == 0) std::copy_n("HDRL", 4, bytes.begin());
      sender.send_to(asio::buffer(bytes.data(), dice() % bytes.size()), to);
      sleep_until(monotonic_now() + 200 * kMicrosecond);
    }
  }
};

TEST_F(CellFaultTest, ADeadSlaveIsAFaultAndItsSuccessorCanBeEngaged) {
  order("engage: true");
  slave->kill();
  ASSERT_TRUE(reaches("fault"));
  EXPECT_EQ(status().reason(), std::string(describe(Reason::kLinkLost)));
  EXPECT_THAT(refusal("engage: true"), HasSubstr("link lost"));
  start_slave();
  ASSERT_TRUE(slave_reaches("off"));
  EXPECT_EQ(status().state(), "fault") << "stays until the operator resets it";
  reset_and_engage();
}

TEST_F(CellFaultTest, AFrozenSlaveIsAFaultAndStaysOneWhenItThaws) {
  order("engage: true");
  slave->send(SIGSTOP);
  ASSERT_TRUE(reaches("fault"));
  slave->send(SIGCONT);
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() < 20.0; }));
  EXPECT_EQ(status().state(), "fault");
  reset_and_engage();
}

TEST_F(CellFaultTest, ADeadMasterStopsTheSlaveAndItsSuccessorCanEngage) {
  order("engage: true");
  master->kill();
  client.close();
  start_master();  // on the socket file that the dead one left
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  EXPECT_NE(status().slave_state(), "engaged");
  reset_and_engage();
}

TEST_F(CellFaultTest, AKilledHoldEndsTheEngagementAndIsSaid) {
  Program hold(folder, "handrail", {"engage", "--hold", "--socket", socket()});
  (void)hold.after("engaged while this runs");
  ASSERT_TRUE(slave_reaches("engaged"));
  order("hand { displacement_mm: [0, 40, 0] duration_s: 20 }");
  hold.kill();
  ASSERT_TRUE(slave_reaches("off"));
  EXPECT_EQ(status().state(), "off");
  EXPECT_EQ(status().ledger().sentence(),
            std::string("the arm holds: ") + describe(Reason::kPresence));
  EXPECT_THAT(status().ledger().way_out(), HasSubstr("handrail engage --hold"));
  order("engage: true");
}

TEST_F(CellFaultTest, AHapticThreadThatStandsStillStopsTheArmUntilAnOperatorResets) {
  order("engage: true");
  order("hand { displacement_mm: [0, 40, 0] duration_s: 20 }");
  const Vec3 start = mm(status().slave_command());
  ASSERT_TRUE(eventually(
      [&](const pb::Status& s) { return (mm(s.slave_command()) - start).norm() > 1.0; }));
  const auto threads = other_threads(master->pid());
  ASSERT_FALSE(threads.empty());
  {
    const StoppedThread haptic(threads.back());  // ThreadSanitizer's own comes before it
    if (!haptic.stopped()) GTEST_SKIP() << "no thread can be stopped here";
    ASSERT_TRUE(slave_reaches("fault"));
    const pb::Status stands = status();
    EXPECT_EQ(stands.slave_reason(), describe(Reason::kLinkLost));
    EXPECT_EQ(stands.ledger().sentence(),
              std::string("the arm holds: ") + describe(Reason::kThreadStalled));
    EXPECT_THAT(refusal("stop: true"), HasSubstr("the haptic loop stands still"));
    EXPECT_EQ(mm(status().slave_command()), mm(stands.slave_command()));
  }
  ASSERT_TRUE(reaches("fault")) << "the stop acts now";
  EXPECT_EQ(status().reason(), std::string(describe(Reason::kStopRequested)));
  EXPECT_NE(master->after("the haptic loop runs again"), "");
  reset_and_engage();
}

TEST_F(CellFaultTest, ADeadControllerIsAFaultAndTheSlaveConnectsAgain) {
  order("engage: true");
  rig->kill();
  ASSERT_TRUE(slave_reaches("fault"));
  ASSERT_TRUE(reaches("fault"));
  const std::string why = status().slave_reason();
  EXPECT_TRUE(why == describe(Reason::kRobotLost) || why == describe(Reason::kSensorMissing))
      << why;
  EXPECT_TRUE(slave->after(describe(Reason::kRobotLost)).starts_with(": reset"));
  EXPECT_TRUE(slave->running());
  start_rig();
  reset_and_engage();
}

TEST_F(CellFaultTest, GarbageOnTheLinkIsCountedAndChangesNothing) {
  order("engage: true");
  const pb::Status before = at_rest();
  send_garbage(master_port, 300);
  send_garbage(slave_port, 300);
  EXPECT_TRUE(eventually([&](const pb::Status& s) {
    return s.datagrams_rejected() >= before.datagrams_rejected() + 250;
  }));
  EXPECT_TRUE(reaches("engaged"));
  EXPECT_LT((mm(at_rest().slave_command()) - mm(before.slave_command())).norm(), 0.01);
  order("disengage: true");
  slave->send(SIGTERM);
  EXPECT_EQ(slave->finish(), 0);
  EXPECT_GE(slave->number_after("datagrams accepted, "), 250);
}

class AlarmTest : public CellFaultTest {
 protected:
  AlarmTest() { rig_extra = "mxttout_cycles: 60"; }
};

TEST_F(AlarmTest, AnAlarmOfTheControllerIsAFaultUntilBothAreReset) {
  order("engage: true");
  slave->send(SIGSTOP);
  EXPECT_NE(rig->after("alarm: "), "");
  slave->send(SIGCONT);
  ASSERT_TRUE(slave_reaches("fault"));
  EXPECT_NE(slave->after(describe(Reason::kRobotLost)), "");
  EXPECT_TRUE(slave->running());
  rig->send(SIGUSR1);
  (void)rig->after("alarm reset");
  reset_and_engage();
}

class PortTest : public WholeCell {};

TEST_F(PortTest, APortInUseIsNamed) {
  const std::string taken = std::to_string(master_port);
  const auto second = launch("handrail-master", "link_port: " + taken + " operator_socket: '" +
                                                    folder.path() + "/other.sock'");
  EXPECT_EQ(second->finish(), 2);
  EXPECT_THAT(second->output(), HasSubstr("link port " + taken));
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/other.sock"));
}

TEST_F(PortTest, ASecondMasterOnTheSocketIsRefusedAndTheFirstServesOn) {
  const auto second = launch("handrail-master", master_config(0));
  EXPECT_EQ(second->finish(), 2);
  EXPECT_THAT(second->output(), HasSubstr("another master answers on it"));
  EXPECT_THAT(second->output(), HasSubstr(socket()));
  client.close();
  order("engage: true");
}

TEST(Programs, NamePlaceAndValueOfABadConfiguration) {
  TempFolder folder;
  const struct {
    const char* program;
    const char* text;
    const char* place;
    const char* value;
  } cases[] = {{"handrail-master", "link_port: 0\n\n  slave_port: 70000\n", ":3:", "70000"},
               {"handrail-master", "link_prot: 1\n", ":1:", "link_prot"},
               {"handrail-master", "device {\n  hand { mass_kg: -1 }\n}\n", ":2:", "mass_kg"},
               {"handrail-slave", "robot {\n  packet_bytes: 65\n}\n", ":2:", "65"},
               {"handrail-slave", "scene 'x'\n", ":1:", "scene"},
               {"handrail-rig", "seed: 1\ndrop_share: 2\n", ":2:", "drop_share"}};
  for (const auto& c : cases) {
    const std::string file = folder.write("bad.cfg", c.text);
    Program program(folder, c.program, {"--check", "--config", file});
    EXPECT_EQ(program.finish(), 2) << c.text;
    EXPECT_THAT(program.output(), HasSubstr(std::string(c.program) + ": " + file + c.place))
        << c.text;
    EXPECT_THAT(program.output(), HasSubstr(c.value)) << c.text;
  }
}

TEST(Programs, CheckTheirDefaultsWithoutStarting) {
  TempFolder folder;
  for (const char* name : {"handrail-master", "handrail-slave", "handrail-rig"}) {
    Program program(folder, name, {"--check"});
    EXPECT_EQ(program.finish(), 0) << name;
    EXPECT_THAT(program.output(), HasSubstr("ok")) << name;
  }
}

}  // namespace
}  // namespace handrail
