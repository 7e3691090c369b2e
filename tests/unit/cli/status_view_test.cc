#include "client/cli/status_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "server/model/reason.h"

namespace handrail {
namespace {

using testing::HasSubstr;

pb::Status engaged() {
  pb::Status s;
  s.set_state("engaged");
  s.set_reason("joint speed limit: following more slowly");
  s.set_slave_state("engaged");
  s.set_packet_age_ms(0.61);
  s.set_loss_share(0.013);
  s.set_round_trip_ms(-1);
  s.mutable_loop_lateness_us()->set_p999(41.25);
  s.mutable_position_tool()->set_kind("line");
  s.mutable_position_tool()->set_id(3);
  s.mutable_position_tool()->set_deviation_mm(0.4213);
  s.mutable_tool_force()->set_magnitude_n(0.337);
  for (const double x : {350.0, -150.5, 429.0}) s.mutable_tip()->add_position_mm(x);
  return s;
}

TEST(StatusView, ShowsStateReasonLinkLoopToolsAndForces) {
  const std::string text = status_text(engaged());
  EXPECT_THAT(text, HasSubstr("session    engaged  reason: joint speed limit"));
  EXPECT_THAT(text, HasSubstr("age 0.61 ms  loss 1.3 %  round trip none yet"));
  EXPECT_THAT(text, HasSubstr("p99.9 41.2"));
  EXPECT_THAT(text, HasSubstr("position: line #3, 0.421 mm off"));
  EXPECT_THAT(text, HasSubstr("orientation: none"));
  EXPECT_THAT(text, HasSubstr("tool 0.337  spring 0.000  limits 0.000  device 0.000"));
  EXPECT_THAT(text, HasSubstr("tip            350.00  -150.50   429.00"));
}

TEST(StatusView, ProgramsThatDifferAreNamedWithBothVersions) {
  pb::Status s = engaged();
  s.mutable_program()->set_version("0.2.0");
  s.mutable_program()->set_wire_version(8);
  *s.mutable_slave_program() = s.program();
  EXPECT_THAT(status_text(s), testing::Not(HasSubstr("differs")));
  s.mutable_slave_program()->set_version("0.1.0");
  EXPECT_THAT(status_text(s), HasSubstr("differs: version: master 0.2.0, slave 0.1.0"));
  s.mutable_slave_program()->Clear();
  s.mutable_slave_program()->set_wire_version(9);
  EXPECT_THAT(status_text(s), HasSubstr("differs: wire version: master 8, slave 9"));
}

// All that a master can say while nothing is wrong but the hand being slowed.
pb::Status usual() {
  pb::Status s = engaged();
  s.set_desired("engaged");
  s.set_slave_reason("joint acceleration limit: following more slowly");
  s.set_scene("screw-fastening");
  s.set_slave_scene("screw-fastening");
  s.set_device("Phantom Omni");
  s.set_device_simulated(true);
  s.set_hand_moving(true);
  s.set_round_trip_ms(102.31);
  s.set_oldest_applied_ms(103.45);
  s.set_link_quality("EXCELLENT");
  s.set_peer_quality("EXCELLENT");
  s.set_loop_age_ms(103.99);
  s.set_datagrams_accepted(123456789);
  s.set_ticks(123456789);
  s.set_realtime(
      "memory not locked (no permission to lock all of it), timer slack 1 ns, ordinary "
      "scheduling (Operation not permitted)");
  s.mutable_lease()->set_holder("anna");
  s.mutable_ledger()->set_sentence(
      "the arm is 14.1 mm from the hand: 11.8 mm limits: joint acceleration limit: following more "
      "slowly (J1); 2.1 mm link (loop 62 ms); 0.3 mm tool");
  s.mutable_ledger()->set_way_out("wait, or move slower");
  s.set_has_contact_force(true);
  for (const double x : {-12.34, 123.45, -0.12}) s.add_contact_force_n(x);
  for (pb::PoseMm* pose :
       {s.mutable_command(), s.mutable_slave_command(), s.mutable_tip(), s.mutable_hand()}) {
    pose->clear_position_mm();
    for (const double x : {-350.123, -950.5, 429.25}) pose->add_position_mm(x);
    for (const double x : {-0.5, 0.5, -0.5, 0.5}) pose->add_quaternion(x);
  }
  return s;
}

// Everything at once, each as long as it can be: of a scene with an arm.
pb::Status fullest() {
  pb::Status s = usual();
  pb::HandleStatus& handle = *s.mutable_handle();
  handle.set_sensor("simulated handle sensor");
  handle.set_state("sound");
  handle.mutable_force()->set_magnitude_n(12.345);
  for (const double x : {-1.234, -12.345, 1.234}) handle.add_stick_torque_n_m(x);
  handle.set_felt_share(-1.0);
  const std::string longest = describe(Reason::kEncoderInvalid);
  s.set_state("fault");
  s.set_reason(std::string(describe(Reason::kPeerFault)) + ": " + longest);
  s.set_slave_reason(longest);
  for (int i = 1; i < static_cast<int>(Reason::kCount); ++i) {
    s.add_interventions(describe(static_cast<Reason>(i)));
  }
  for (const char* section : {"scene", "mapping", "limits", "robot", "tools"}) {
    s.add_hash_mismatch(std::string(section) + ": master 0123456789abcdef, slave fedcba9876543210");
  }
  s.set_log_lost(123456789);
  s.set_slave_log_lost(true);
  s.mutable_lease()->set_holder("abcdefghijklmnopqrstuvwxyz012345");
  s.mutable_lease()->set_asked_by("543210zyxwvutsrqponmlkjihgfedcba");
  s.mutable_ledger()->set_way_out(
      "at the controller: clear its alarm, if there is one, and start its program in AUTOMATIC; "
      "the slave's log names other causes, then reset and engage");
  s.set_scene("a-scene-whose-name-has-as-many-letters-as-it-may");
  s.set_slave_scene(s.scene());
  for (pb::ToolStatus* tool : {s.mutable_position_tool(), s.mutable_orientation_tool()}) {
    tool->set_kind("n-rotation");
    tool->set_id(4294967295u);
    tool->set_blending(true);
    tool->set_deviation_mm(123.456);
    tool->set_deviation_deg(123.45);
  }
  return s;
}

// ... and of one with walls, in which no arm can differ.
pb::Status fullest_walls() {
  pb::Status s = fullest();
  s.clear_hash_mismatch();
  s.mutable_walls()->set_stage_name("a stage with quite a long name of its own");
  s.mutable_walls()->set_touching(true);
  s.mutable_walls()->set_region_name("a region with quite a long name of its own");
  s.mutable_walls()->set_locked(true);
  s.mutable_walls()->set_place("and a place");
  return s;
}

long rows_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(StatusView, FitsATerminalOf80By24) {
  for (const pb::Status& s : {usual(), fullest(), fullest_walls()}) {
    const std::string text = status_text(s, kTerminalRows);
    EXPECT_LE(rows_of(text), kTerminalRows) << text;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 80u) << line;
      EXPECT_FALSE(line.ends_with(' ')) << line;
    }
  }
}

TEST(StatusView, WhereRowsAreShortTheMostImportantStayAndItSaysWhatIsCut) {
  const std::string all = status_text(fullest()), text = status_text(fullest(), kTerminalRows);
  EXPECT_GT(rows_of(all), 60);
  EXPECT_EQ(all.find(" ..."), std::string::npos);
  for (const char* part :
       {"session    fault  reason: the other side is in fault: ", "also: not engaged ...",
        "differs: scene: master 0123456789abcdef, slave fedcba9876543210 ...",
        "why        the arm is 14.1 mm", "lease      abcdef", "scene      a-scene",
        "link       age", "loop       ticks", "real time: memory not locked",
        "log lines lost: 123456789 of the master", "tools      position: n-rotation",
        "orientation: n-rotation", "force [N]", "touch [N]", "pose [mm]", "slave command", "tip  ",
        "hand  "}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(status_text(fullest_walls(), kTerminalRows),
              HasSubstr("walls      stage 0 'a stage"));
  EXPECT_EQ(status_text(usual(), 60), status_text(usual())) << "nothing is cut where there is room";
}

TEST(StatusView, ShowsWhatIsFeltBesideWhatIsAskedFor) {
  pb::Status s = engaged();
  EXPECT_THAT(status_text(s), testing::Not(HasSubstr("felt")));
  pb::HandleStatus& handle = *s.mutable_handle();
  handle.set_sensor("ATI Net F/T");
  handle.set_state("silent");
  EXPECT_THAT(status_text(s), HasSubstr("felt [N]   silent  ATI Net F/T\n"));
  handle.set_state("sound");
  handle.mutable_force()->set_magnitude_n(2.0);
  for (const double x : {0.0, -0.3, 0.0}) handle.add_stick_torque_n_m(x);
  EXPECT_THAT(status_text(s), HasSubstr("felt [N]   handle 2.000  stick 0.00 -0.30 0.00 N m  ATI"));
  handle.set_felt_share(0.874);
  handle.set_simulated(true);
  EXPECT_THAT(status_text(s), HasSubstr("87 % of what the device was told"));
  EXPECT_THAT(status_text(s), HasSubstr("simulated"));
}

TEST(StatusView, NamesEverySectionThatDiffers) {
  pb::Status s = engaged();
  s.add_hash_mismatch("mapping: master 3f2a, slave 91bc");
  EXPECT_THAT(status_text(s), HasSubstr("differs: mapping: master 3f2a, slave 91bc"));
}

TEST(StatusView, ShowsTheWallsOfASceneThatHasThem) {
  pb::Status s = engaged();
  EXPECT_THAT(status_text(s), testing::Not(HasSubstr("walls")));
  s.mutable_walls()->set_stage(1);
  EXPECT_THAT(status_text(s), HasSubstr("walls      stage 1  free\n"));
  s.mutable_walls()->set_stage_name("open");
  EXPECT_THAT(status_text(s), HasSubstr("walls      stage 1 'open'  free\n"));
  s.mutable_walls()->clear_stage_name();
  s.mutable_walls()->set_touching(true);
  s.mutable_walls()->set_penetration_mm(0.417);
  s.mutable_walls()->set_region_name("aisle");
  s.mutable_walls()->set_locked(true);
  s.mutable_walls()->set_place("3");
  EXPECT_THAT(status_text(s),
              HasSubstr("walls      stage 1  0.42 mm in a wall at 'aisle'  locked in '3'\n"));
}

TEST(StatusView, ShowsAnEmptyStatusWithoutInventingValues) {
  const std::string text = status_text(pb::Status());
  EXPECT_THAT(text, HasSubstr("no sensor"));
  EXPECT_THAT(text, HasSubstr("tip           -"));
}

}  // namespace
}  // namespace handrail
