// Every field that operators see, from a report made by hand.
#include "server/master/status_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/base/version.h"
#include "server/link/codec.h"

namespace handrail {
namespace {

using google::protobuf::FieldDescriptor;

void expect_vector(const google::protobuf::RepeatedField<double>& got, const Vec3& want) {
  ASSERT_EQ(got.size(), 3);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[i], want[i], 1e-9) << i;
}

// Every number in the message and in those within it.
void expect_finite(const google::protobuf::Message& message) {
  const auto* reflection = message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const bool is_double = field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
    const bool is_message = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (field->is_repeated()) {
      for (int i = 0; is_double && i < reflection->FieldSize(message, field); ++i) {
        EXPECT_TRUE(std::isfinite(reflection->GetRepeatedDouble(message, field, i)))
            << field->full_name();
      }
    } else if (is_double) {
      EXPECT_TRUE(std::isfinite(reflection->GetDouble(message, field))) << field->full_name();
    } else if (is_message) {
      expect_finite(reflection->GetMessage(message, field));
    }
  }
}

class StatusReportTest : public ::testing::Test {
 protected:
  StatusReportTest() {
    identity = {"scripted device", true, "SCHED_FIFO 85"};
    link.peer_epoch = 1;
    link.received_at = now - 2 * kMillisecond;
    slave.scene = report.out.link.scene = scene_name("first");
  }
  pb::Status status() const { return status_report(identity, report, slave, link, now); }

  MasterIdentity identity;
  HapticReport report;
  SlaveState slave;
  LinkSnapshot link;
  Nanos now = 50 * kSecond;
};

TEST_F(StatusReportTest, SaysWhatTheSessionIs) {
  MasterState& own = report.out.link;
  own.desired = Desired::kClutched;
  own.state = SessionState::kHold;
  report.out.reason = Reason::kLinkHold;
  slave.state = SessionState::kEngaged;
  slave.reason = Reason::kBumper;
  slave.scene = scene_name("second");
  const pb::Status s = status();
  EXPECT_EQ(s.desired(), "clutched");
  EXPECT_EQ(s.state(), "hold");
  EXPECT_EQ(s.reason(), describe(Reason::kLinkHold));
  EXPECT_EQ(s.slave_state(), "engaged");
  EXPECT_EQ(s.slave_reason(), describe(Reason::kBumper));
  EXPECT_EQ(s.scene(), "first");
  EXPECT_EQ(s.slave_scene(), "second");
  EXPECT_EQ(s.device(), "scripted device");
  EXPECT_TRUE(s.device_simulated());
  EXPECT_EQ(s.realtime(), "SCHED_FIFO 85");
  EXPECT_EQ(s.time_s(), 50.0);
}

TEST_F(StatusReportTest, NamesTheMasterThatLeadsTheSlave) {
  report.out.reason = Reason::kLinkLost;
  link.received_at = now - 2 * kSecond;
  link.refused_at = now - kSecond;
  link.refusal = {1, false, fixed_text<LeaderName>("process 4711"), 11 * kSecond};
  EXPECT_EQ(status().reason(), "the slave is led by another master (process 4711, for 12 s)");
  link.received_at = now;
  EXPECT_EQ(status().reason(), describe(Reason::kLinkLost));
}

TEST_F(StatusReportTest, SaysWhatBothProgramsAreAndWhatTheirThreadsHave) {
  identity.grants = {true, false, true};
  slave.program = {1000 * kSecond, version_code("1.2.3"), {false, true, false}};
  link.round_trip = 6 * kMillisecond;
  const pb::ProgramStatus own = status().program(), its = status().slave_program();
  EXPECT_EQ(own.version(), program_version());
  EXPECT_EQ(own.wire_version(), kWireVersion);
  EXPECT_NEAR(own.calendar_s(), to_seconds(calendar_now()), 60.0);
  EXPECT_TRUE(own.control_fifo() && own.io_fifo());
  EXPECT_FALSE(own.memory_locked());
  EXPECT_EQ(its.version(), "1.2.3");
  EXPECT_EQ(its.wire_version(), kWireVersion);
  EXPECT_NEAR(its.calendar_s(), 1000.005, 1e-9) << "2 ms since it came, 3 ms on the way";
  EXPECT_FALSE(its.control_fifo() || its.io_fifo());
  EXPECT_TRUE(its.memory_locked());
}

TEST_F(StatusReportTest, OfASlaveThatIsNotHeardOrOfAnotherVersionNothingElseIsKnown) {
  link.peer_epoch = 0;
  EXPECT_FALSE(status().has_slave_program());
  link.other_wire = 9;
  link.other_wire_at = now - kMillisecond;
  EXPECT_EQ(status().slave_program().wire_version(), 9u);
  EXPECT_FALSE(status().slave_program().has_version());
  link.peer_epoch = 1;
  link.received_at = now - 13 * kSecond;
  link.other_wire_at = -kForever;
  EXPECT_FALSE(status().has_slave_program()) << "silent for too long";
}

TEST_F(StatusReportTest, WhatAnEngageAsksStandsBesideWhatWasMeasured) {
  identity.loop_warn = 100 * kMillisecond;
  identity.loop_limit = 600 * kMillisecond;
  report.out.link_window = 2 * kSecond;
  report.out.link_shares = {0.01, 0.02, 0.03, 0.04, 0.5};
  const pb::LinkGate gate = status().gate();
  EXPECT_EQ(gate.window_s(), 2.0);
  EXPECT_EQ(gate.heard_share(), 0.5);
  EXPECT_EQ(gate.held_share(), 0.01);
  EXPECT_EQ(gate.peer_held_share(), 0.02);
  EXPECT_EQ(gate.most_held_share(), 0.09);
  EXPECT_EQ(gate.lost_share(), 0.03);
  EXPECT_EQ(gate.peer_lost_share(), 0.04);
  EXPECT_EQ(gate.most_lost_share(), 0.25);
  EXPECT_NEAR(gate.loop_warn_ms(), 100.0, 1e-9);
  EXPECT_NEAR(gate.loop_limit_ms(), 600.0, 1e-9);
}

TEST_F(StatusReportTest, WhereASlaveIsLookedForIsSaidWithAndWithoutASession) {
  identity.slave_at = "arm.example";
  LinkIdentity peer{true, "", "", "", 0, "nobody is there: start it", "start it"};
  identity.link = [&peer](Nanos) { return peer; };
  EXPECT_EQ(status().peer().place(), "arm.example");
  EXPECT_EQ(status().peer().problem(), "nobody is there: start it");
  EXPECT_EQ(status().peer().next(), "start it");
  EXPECT_FALSE(status().peer().has_address()) << "the name has none";
  peer.address = "192.0.2.7:47002";
  EXPECT_EQ(status().peer().address(), "192.0.2.7:47002");
  EXPECT_FALSE(status().peer().has_name());
}

TEST_F(StatusReportTest, ASceneOfWallsHasNoSlave) {
  slave.scene = scene_name("other");
  report.walls.present = true;
  EXPECT_EQ(status().slave_state(), "none");
  EXPECT_EQ(status().hash_mismatch_size(), 0);
}

TEST_F(StatusReportTest, TheSlavesReasonStandsWhereTheMasterHasNone) {
  slave.reason = Reason::kOutOfReach;
  EXPECT_EQ(status().reason(), describe(Reason::kOutOfReach));
  slave.reason = Reason::kNone;
  EXPECT_EQ(status().reason(), "none");
}

TEST_F(StatusReportTest, CountsLoopAndLink) {
  report.ticks = 1000;
  report.overruns = 3;
  report.late_p50 = 50'000;
  report.late_p99 = 120'000;
  report.late_p999 = 250'000;
  report.late_max = 1'500'000;
  link.loss_share = 0.04;
  link.round_trip = 700'000;
  link.accepted = 12;
  link.rejected = 5;
  slave.oldest_applied = 3 * kMillisecond;
  slave.silences = 6;
  const pb::Status s = status();
  EXPECT_EQ(s.ticks(), 1000u);
  EXPECT_EQ(s.overruns(), 3u);
  EXPECT_NEAR(s.loop_lateness_us().p50(), 50.0, 1e-9);
  EXPECT_NEAR(s.loop_lateness_us().p99(), 120.0, 1e-9);
  EXPECT_NEAR(s.loop_lateness_us().p999(), 250.0, 1e-9);
  EXPECT_NEAR(s.loop_lateness_us().max(), 1500.0, 1e-9);
  EXPECT_NEAR(s.packet_age_ms(), 2.0, 1e-9);
  EXPECT_EQ(s.loss_share(), 0.04);
  EXPECT_NEAR(s.round_trip_ms(), 0.7, 1e-9);
  EXPECT_EQ(s.datagrams_accepted(), 12u);
  EXPECT_EQ(s.datagrams_rejected(), 5u);
  EXPECT_NEAR(s.oldest_applied_ms(), 3.0, 1e-9);
  EXPECT_EQ(s.slave_overruns(), 6u);
}

TEST_F(StatusReportTest, DescribesTheTools) {
  ToolDefinition& line = report.out.link.position_tool;
  line.kind = ToolKind::kLine;
  line.id = 7;
  line.epoch = 9;
  line.direction_S = Vec3::UnitX();
  report.out.link.orientation_tool.kind = ToolKind::kFRotation;
  report.out.deviation = 0.0012;
  report.out.deviation_angle = 0.1;
  report.out.blending = true;
  const pb::Status s = status();
  EXPECT_EQ(s.position_tool().kind(), "line");
  EXPECT_EQ(s.position_tool().id(), 7u);
  EXPECT_EQ(s.position_tool().epoch(), 9u);
  EXPECT_EQ(s.position_tool().hash(), hash_of(line));
  EXPECT_TRUE(s.position_tool().blending());
  EXPECT_NEAR(s.position_tool().deviation_mm(), 1.2, 1e-9);
  EXPECT_FALSE(s.position_tool().has_deviation_deg());
  EXPECT_EQ(s.orientation_tool().kind(), "f-rotation");
  EXPECT_NEAR(s.orientation_tool().deviation_deg(), 0.1 / kDeg, 1e-9);
  EXPECT_FALSE(s.orientation_tool().has_deviation_mm());
}

TEST_F(StatusReportTest, NamesEveryToolAsTheCommandLineDoes) {
  const std::pair<ToolKind, const char*> names[] = {{ToolKind::kNone, "none"},
                                                    {ToolKind::kPoint, "point"},
                                                    {ToolKind::kLine, "line"},
                                                    {ToolKind::kPlane, "plane"},
                                                    {ToolKind::kNRotation, "n-rotation"},
                                                    {ToolKind::kFRotation, "f-rotation"}};
  for (const auto& [kind, name] : names) {
    report.out.link.position_tool.kind = kind;
    EXPECT_EQ(status().position_tool().kind(), name);
  }
}

TEST_F(StatusReportTest, GivesForcesInNewtonsAndPosesInMillimetres) {
  ForceShares& shares = report.out.shares;
  shares.tool = Vec3(0.3, 0, 0.4);
  shares.spring = Vec3(0, 0.1, 0);
  shares.limited = Vec3(0, -0.02, 0);
  shares.device = Vec3(0.3, 0.08, 0.4);
  MasterState& own = report.out.link;
  own.has_command = true;
  own.X_SU = {Vec3(0.35, 0.001, 0.429), rotation_exp({0.3, 0, 0})};
  slave.has_pose = true;
  slave.X_ST_command.p = Vec3(0.34, 0, 0.42);
  slave.X_ST.p = Vec3(0.33, 0, 0.41);
  slave.has_wrench = true;
  slave.f_E_S.force = Vec3(1, 2, -3);
  report.X_MH.p = Vec3(0.01, 0, -0.02);
  report.hand_moving = true;
  const pb::Status s = status();
  EXPECT_NEAR(s.tool_force().magnitude_n(), 0.5, 1e-12);
  expect_vector(s.tool_force().force_n(), shares.tool);
  expect_vector(s.spring_force().force_n(), shares.spring);
  expect_vector(s.limited_force().force_n(), shares.limited);
  expect_vector(s.device_force().force_n(), shares.device);
  expect_vector(s.command().position_mm(), Vec3(350, 1, 429));
  ASSERT_EQ(s.command().quaternion_size(), 4);
  EXPECT_NEAR(s.command().quaternion(0), std::cos(0.15), 1e-12);
  EXPECT_NEAR(s.command().quaternion(1), std::sin(0.15), 1e-12);
  expect_vector(s.slave_command().position_mm(), Vec3(340, 0, 420));
  expect_vector(s.tip().position_mm(), Vec3(330, 0, 410));
  expect_vector(s.hand().position_mm(), Vec3(10, 0, -20));
  EXPECT_TRUE(s.hand_moving());
  EXPECT_TRUE(s.has_contact_force());
  expect_vector(s.contact_force_n(), Vec3(1, 2, -3));
}

TEST_F(StatusReportTest, SaysMinusOneAndNoneForWhatIsNotThere) {
  link = LinkSnapshot();
  slave.has_pose = slave.has_wrench = true;  // of a slave that never spoke: means nothing
  const pb::Status s = status();
  EXPECT_EQ(s.packet_age_ms(), -1.0);
  EXPECT_EQ(s.round_trip_ms(), -1.0);
  EXPECT_EQ(s.slave_state(), "none");
  EXPECT_EQ(s.reason(), describe(Reason::kNoPeer));
  EXPECT_EQ(s.slave_reason(), describe(Reason::kNoPeer));
  EXPECT_EQ(s.slave_scene(), "");
  EXPECT_FALSE(s.has_command());
  EXPECT_FALSE(s.has_slave_command());
  EXPECT_FALSE(s.has_tip());
  EXPECT_FALSE(s.has_contact_force());
  EXPECT_EQ(s.contact_force_n_size(), 0);
  EXPECT_EQ(s.hash_mismatch_size(), 0);
}

TEST_F(StatusReportTest, TellsEachSectionThatDiffers) {
  EXPECT_EQ(status().hash_mismatch_size(), 0);
  report.out.link.hashes = {1, 0x3f2a, 5, 6};
  slave.hashes = {2, 0x91bc, 5, 7};
  slave.scene = scene_name("second");
  const pb::Status s = status();
  ASSERT_EQ(s.hash_mismatch_size(), 4);
  EXPECT_EQ(s.hash_mismatch(0), "scene: master 'first', slave 'second'");
  EXPECT_EQ(s.hash_mismatch(1), "mapping: master 0000000000003f2a, slave 00000000000091bc");
  EXPECT_EQ(s.hash_mismatch(2), "robot: master 0000000000000006, slave 0000000000000007");
  EXPECT_EQ(s.hash_mismatch(3), "tools: master 0000000000000001, slave 0000000000000002");
  slave.position_tool_epoch = 1;
  EXPECT_EQ(status().hash_mismatch_size(), 3) << "tools still on their way are not compared";
}

TEST_F(StatusReportTest, EveryNumberIsFiniteWithAndWithoutASlave) {
  expect_finite(status());
  link = LinkSnapshot();
  expect_finite(status());
  slave.oldest_applied = kForever;
  link.peer_epoch = 1;
  link.received_at = -kForever;
  link.round_trip = kForever;
  expect_finite(status());
  EXPECT_EQ(status().packet_age_ms(), -1.0);
  EXPECT_EQ(status().round_trip_ms(), -1.0);
}

TEST(LinkQualityText, NamesWhatWasMeasuredAndWhatIsAsked) {
  HapticOutput out;
  out.link_window = kSecond;
  out.link_shares.heard = 1.0;
  LinkSnapshot link;
  link.peer_epoch = 1;
  link.received_at = 0;
  link.received_of_100 = link.peer_received_of_100 = 90;
  const auto text = [&](Nanos now = 0) { return link_quality_text(out, link, now); };
  const std::string plain = describe(Reason::kLinkQuality);
  EXPECT_EQ(text(), plain) << "it has become good meanwhile";
  out.link_shares.held = 0.09;
  out.link_shares.lost = 0.25;
  EXPECT_EQ(text(), plain);
  out.link_shares.held = 0.124;
  EXPECT_EQ(text(), plain +
                        ": 12.4 % of the time nothing new here for over 20 ms, at most 9 % in "
                        "1 s is asked");
  out.link_shares.held = 0.0;
  out.link_shares.peer_held = 0.31;
  out.link_shares.peer_lost = 0.603;
  EXPECT_EQ(text(), plain +
                        ": 31.0 % of the time nothing new at the slave for over 20 ms, at most "
                        "9 % in 1 s is asked; 60.3 % lost on the way to the slave, at most 25 "
                        "% in 1 s is asked");
  out.link_shares = {};
  out.link_shares.heard = 0.417;
  EXPECT_EQ(text(), plain +
                        ": heard both ways for 0.42 s without a gap of over 200 ms, 1 s is "
                        "asked");
  // Of a bad moment alone.
  out.link_shares.heard = 1.0;
  EXPECT_EQ(text(23 * kMillisecond), plain + ": nothing new here for 23 ms, at most 20 is asked");
  link.peer_received_of_100 = 39;
  EXPECT_EQ(text(), plain + ": 39 of 100 came, at least 40 are asked");
}

}  // namespace
}  // namespace handrail
