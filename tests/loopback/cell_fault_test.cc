// The real programs when one of them dies, freezes or is told nonsense.
#include <gmock/gmock.h>

#include <filesystem>
#include <optional>

#include "server/model/reason.h"
#include "tests/loopback/stopped_thread.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/notify_socket.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_NE(master->after("the haptic loop runs again: it stood still for "), "");
  reset_and_engage();
}

// A service manager that restarts what falls silent hears of it before the arm's link is lost.
class WatchedCell : public CellFaultTest {
 protected:
  void SetUp() override {
    manager_.emplace(folder.path() + "/notify", "1000000");
    CellFaultTest::SetUp();
  }
  // Stops the control thread of `watched`, alone with the manager, and lets it go on.
  void expect_silence_while_the_control_thread_stands(Program& watched) {
    manager_->forget();
    ASSERT_TRUE(manager_->hears("WATCHDOG=1", kSecond));
    const auto threads = other_threads(watched.pid());
    ASSERT_FALSE(threads.empty());
    {
      const StoppedThread control(threads.back());
      if (!control.stopped()) GTEST_SKIP() << "no thread can be stopped here";
      // What it said before is still to be read.
      const Nanos start = monotonic_now();
      Nanos last = start;
      while (monotonic_now() - last < 300 * kMillisecond) {
        if (!manager_->next(kMillisecond).empty()) last = monotonic_now();
      }
      EXPECT_LT(last - start, 50 * kMillisecond);
    }
    EXPECT_TRUE(manager_->hears("WATCHDOG=1", kSecond)) << "it runs again";
    watched.send(SIGTERM);
    EXPECT_TRUE(manager_->hears("STOPPING=1", kSecond));
  }

  std::optional<test::NotifySocket> manager_;
};

TEST_F(WatchedCell, AHapticThreadThatStandsStillEndsTheWatchdogsSignsWithin50Milliseconds) {
  slave.reset();  // its signs come by the same socket
  expect_silence_while_the_control_thread_stands(*master);
}

TEST_F(WatchedCell, ARobotThreadThatStandsStillEndsTheWatchdogsSignsWithin50Milliseconds) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  master.reset();
  expect_silence_while_the_control_thread_stands(*slave);
}

TEST_F(CellFaultTest, ADeadControllerIsAFaultAndTheSlaveConnectsAgain) {
  order("engage: true");
  rig->kill();
  ASSERT_TRUE(slave_reaches("fault"));
  ASSERT_TRUE(reaches("fault"));
  const std::string why = status().slave_reason();
  EXPECT_TRUE(why == describe(Reason::kRobotLost) || why == describe(Reason::kSensorMissing))
      << why;
  EXPECT_NE(slave->after("session fault: "), "");
  EXPECT_TRUE(slave->after(describe(Reason::kRobotLost)).starts_with("; a reset tries"));
  EXPECT_NE(master->after("session fault: " + std::string(describe(Reason::kPeerFault)) + ": "),
            "");
  EXPECT_TRUE(slave->running());
  const std::string log = slave->output(), lost = describe(Reason::kRobotLost);
  EXPECT_EQ(log.find(lost), log.rfind(lost)) << "one loss is one line: " << log;
  // A reset that meets no controller says so, and nothing is tried again by itself.
  EXPECT_NE(refusal("reset: true"), "");
  EXPECT_THAT(slave->after(": no answer"), HasSubstr("; a reset tries to connect again"));
  sleep_until(monotonic_now() + 3 * kSecond / 2);
  const std::string since = slave->output();
  EXPECT_THAT(since.substr(since.find(lost)), Not(HasSubstr("trying again")));
  start_rig();
  (void)rig->after("control thread: ");  // it answers from here on
  reset_and_engage();
  EXPECT_NE(slave->after("connected to "), "");
}

// What the slave has forgotten, as it was started anew, is still why the session ended.
TEST_F(CellFaultTest, WhyTheSlaveStoppedIsSaidUntilAnOperatorResets) {
  order("engage: true");
  rig->kill();
  ASSERT_TRUE(reaches("fault"));
  const auto names = [](const std::string& text) {
    return text.find(describe(Reason::kRobotLost)) != text.npos ||
           text.find(describe(Reason::kSensorMissing)) != text.npos;
  };
  slave->kill();
  start_rig();
  start_slave();
  ASSERT_TRUE(slave_reaches("off"));
  const pb::Status s = status();
  EXPECT_TRUE(s.reason().starts_with(describe(Reason::kPeerFault)) && names(s.reason()))
      << s.reason();
  EXPECT_TRUE(names(s.ledger().sentence())) << s.ledger().sentence();
  EXPECT_TRUE(names(refusal("engage: true")));
  EXPECT_TRUE(names(master->after("session fault: ")));
  const auto [code, why] = handrail({"why"});
  EXPECT_TRUE(code == 0 && names(why)) << why;
  EXPECT_TRUE(names(handrail({"status"}).second));
  order("reset: true");
  EXPECT_FALSE(names(status().reason())) << status().reason();
  reset_and_engage();
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

class SocketTest : public WholeCell {};

TEST_F(SocketTest, ASecondSlaveOnTheLinksSocketIsRefusedAndTheFirstServesOn) {
  const auto second = launch("handrail-slave", "link_socket: '" + link_socket + "'");
  EXPECT_EQ(second->finish(), 2);
  EXPECT_EQ(second->output(),
            "handrail-slave: link socket " + link_socket + ": another slave answers on it\n");
  order("engage: true");
  EXPECT_TRUE(slave_reaches("engaged"));
}

TEST_F(SocketTest, ASecondMasterOnTheSocketIsRefusedAndTheFirstServesOn) {
  const auto second = launch("handrail-master", master_config());
  const std::string place = master_place(*second);
  EXPECT_EQ(second->finish(), 2);
  EXPECT_FALSE(std::filesystem::exists(place));
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
  } cases[] = {{"handrail-master", "scene: 'plane'\n\n  loop_limit_ms: 7\n", ":3:", "7"},
               {"handrail-master", "link_sokcet: 'a'\n", ":1:", "link_sokcet"},
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
