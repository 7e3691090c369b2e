// What a recording shows of a moment is what the master said at that moment.
#include "client/console/play/played_status.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include "client/console/gateway/json_text.h"
#include "server/base/random.h"
#include "server/kinematics/arm_of.h"
#include "server/master/status_report.h"
#include "server/record/came_io.h"
#include "server/record/recorded_scenes.h"
#include "server/record/tick_io.h"
#include "tests/unit/record/driven.h"

namespace handrail {
namespace {

using google::protobuf::util::MessageDifferencer;
using ::testing::HasSubstr;

// What the master would have said of that tick, with what only a running one knows left out.
pb::Status told(const pb::RecordedStart& start, const KeptTick& tick, const Scene& scene) {
  HapticReport report;
  report.out = tick.came.out;
  report.X_MH = tick.given.in.hand.X_MH;
  report.ticks = tick.number;
  report.walls.present = tick.came.has_walls;
  LinkSnapshot link;
  link.peer_epoch = tick.given.in.slave_known ? 1 : 0;
  if (tick.given.in.slave_known) link.received_at = tick.at - tick.given.in.slave_age;
  MasterIdentity master;
  master.device = start.device().name();
  pb::Status out = status_report(master, report, tick.given.in.slave, link, tick.at);
  if (!tick.came.has_walls) show_joints(arm_of(scene), tick.given.in.slave, out);
  return out;
}

// Of two statuses the parts that a page draws of an arm.
void expect_same_picture(const pb::Status& is, const pb::Status& was, bool hand_valid) {
  EXPECT_EQ(is.state(), was.state());
  EXPECT_EQ(is.desired(), was.desired());
  EXPECT_EQ(is.slave_state(), was.slave_state());
  EXPECT_EQ(is.reason(), was.reason());
  EXPECT_EQ(is.scene(), was.scene());
  EXPECT_EQ(is.ticks(), was.ticks());
  EXPECT_EQ(is.time_s(), was.time_s());
  const auto same = [](const char* what, const google::protobuf::Message& a,
                       const google::protobuf::Message& b) {
    EXPECT_TRUE(MessageDifferencer::ApproximatelyEquals(a, b))
        << what << ": " << a.ShortDebugString() << " and " << b.ShortDebugString();
  };
  same("tip", is.tip(), was.tip());
  same("command", is.command(), was.command());
  same("slave's command", is.slave_command(), was.slave_command());
  same("position tool", is.position_tool(), was.position_tool());
  same("orientation tool", is.orientation_tool(), was.orientation_tool());
  same("device force", is.device_force(), was.device_force());
  if (hand_valid) same("hand", is.hand(), was.hand());
  EXPECT_EQ(is.interventions_size(), was.interventions_size());
  EXPECT_EQ(is.joints_deg_size(), was.joints_deg_size());
  EXPECT_EQ(is.has_desired_tip(), was.has_desired_tip());
  EXPECT_NEAR(is.ledger().behind_mm(), was.ledger().behind_mm(), 1e-9);
  ASSERT_EQ(is.ledger().motion_size(), was.ledger().motion_size());
  for (int i = 0; i < is.ledger().motion_size(); ++i) {
    EXPECT_NEAR(is.ledger().motion(i).mm(), was.ledger().motion(i).mm(), 1e-9);
  }
  const auto sum = [](const pb::Status& s, int i) {
    return s.tool_force().force_n(i) + s.spring_force().force_n(i) + s.limited_force().force_n(i);
  };
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(sum(is, i), is.device_force().force_n(i), 1e-12);
}

struct Replayed {
  RecordingMoment moment;
  const Scene* scene = nullptr;
};

TEST(PlayedStatus, ShowsOfAnArmWhatTheMasterSaid) {
  test::DrivenMaster master(21);
  RecordedScenes scenes({}, "");
  ASSERT_TRUE(scenes.add(master.scenes().front()));
  const Scene* scene = scenes.find(1);
  KeptTick tick;
  int engaged = 0, led = 0;
  for (int i = 0; i < 4000; ++i) {
    master.tick();
    ASSERT_TRUE(master.tap().take(tick));
    RecordingMoment moment;
    moment.calendar = 1'700'000'000 * kSecond;
    put(tick, moment.tick);
    const auto is = played_status(master.start(), true, moment, scene);
    ASSERT_TRUE(is) << is.message();
    SCOPED_TRACE(i);
    expect_same_picture(*is, told(master.start(), tick, *scene), tick.given.in.hand.valid);
    if (::testing::Test::HasFailure()) return;
    engaged += is->state() == "engaged";
    led += is->has_desired_tip();
    EXPECT_EQ(is->program().calendar_s(), 1.7e9);
    EXPECT_EQ(is->ledger().way_out_order_size(), 0) << "nothing can be ordered";
    EXPECT_FALSE(is->has_lease() || is->has_peer() || is->has_gate() || is->has_overruns());
    EXPECT_EQ(is->named_tool_size(), static_cast<int>(scene->named_tools.size()));
  }
  EXPECT_GT(engaged, 300);
  EXPECT_GT(led, 300);
}

TEST(PlayedStatus, ShowsOfWallsWhereTheHandAndTheProxyAre) {
  for (const char* name : {"gearshift", "wrench"}) {
    SCOPED_TRACE(name);
    test::DrivenMaster master(5, name);
    RecordedScenes scenes({}, "");
    ASSERT_TRUE(scenes.add(master.scenes().front()));
    KeptTick tick;
    int touched = 0;
    for (int i = 0; i < 3000; ++i) {
      master.tick();
      ASSERT_TRUE(master.tap().take(tick));
      RecordingMoment moment;
      put(tick, moment.tick);
      const auto is = played_status(master.start(), true, moment, scenes.find(1));
      ASSERT_TRUE(is) << is.message();
      const pb::WallStatus& walls = is->walls();
      const WallOutput& felt = tick.came.walls;
      ASSERT_EQ(walls.touching(), felt.contact.touching);
      touched += felt.contact.touching;
      ASSERT_NEAR(walls.proxy_mm(0), felt.contact.proxy.x() * 1e3, 1e-9);
      ASSERT_NEAR(walls.hand_mm(1), felt.hand.y() * 1e3, 1e-9);
      ASSERT_NEAR(walls.penetration_mm(), (felt.hand - felt.contact.proxy).norm() * 1e3, 1e-9);
      ASSERT_NEAR(std::hypot(walls.force_n(0), walls.force_n(1)), tick.came.out.f_H_M.force.norm(),
                  1e-9);
      ASSERT_FALSE(walls.region_name().empty());
      ASSERT_EQ(walls.has_turned_rad(), std::string(name) == "wrench");
      if (walls.has_turned_rad()) {
        ASSERT_EQ(walls.turned_rad(), tick.turned);
      }
      ASSERT_FALSE(is->has_tip()) << "no arm takes part";
    }
    EXPECT_GT(touched, 10);
  }
}

// What random driving does not come to.
TEST(PlayedStatus, WhileTheArmHoldsTheHandIsShownAndACueStandsAmongWhatLimits) {
  test::DrivenMaster master(21);
  KeptTick tick;
  RecordingMoment moment;
  for (int i = 0; i < 4000 && moment.tick.command().state() != pb::SESSION_ENGAGED; ++i) {
    master.tick();
    ASSERT_TRUE(master.tap().take(tick));
    put(tick, moment.tick);
  }
  ASSERT_EQ(moment.tick.command().state(), pb::SESSION_ENGAGED);
  const auto shows = [&](pb::LinkSessionState state) {
    moment.tick.mutable_command()->set_state(state);
    const auto is = played_status(master.start(), true, moment, nullptr);
    EXPECT_TRUE(is) << is.message();
    return is && is->has_desired_tip();
  };
  EXPECT_TRUE(shows(pb::SESSION_HOLD));
  EXPECT_FALSE(shows(pb::SESSION_CLUTCHED));
  EXPECT_FALSE(shows(pb::SESSION_OFF));
  // Tool, walls, spring, governor, limits, clamp, cue and device: X of each.
  const double force[] = {1.0, 0.5, 0.25, -0.125, -0.0625, -0.03125, 0.3, 0};
  double sum = 0.0;
  for (int i = 0; i < 7; ++i) moment.tick.set_force(3 * i, force[i]), sum += force[i];
  moment.tick.set_force(21, sum);
  const auto is = played_status(master.start(), true, moment, nullptr);
  ASSERT_TRUE(is) << is.message();
  EXPECT_NEAR(is->tool_force().force_n(0), 1.46875, 1e-12);
  EXPECT_NEAR(is->spring_force().force_n(0), 0.25, 1e-12);
  EXPECT_NEAR(is->limited_force().force_n(0), 0.1125, 1e-12);
  EXPECT_NEAR(is->device_force().force_n(0), sum, 1e-12);
  EXPECT_NEAR(is->ledger().cue().force_n(0), 0.3, 1e-12);
}

TEST(PlayedStatus, WithoutItsSceneItShowsWhatNeedsNone) {
  test::DrivenMaster master(3);
  KeptTick tick;
  for (int i = 0; i < 50; ++i) {
    master.tick();
    ASSERT_TRUE(master.tap().take(tick));
  }
  RecordingMoment moment;
  put(tick, moment.tick);
  const auto is = played_status(master.start(), true, moment, nullptr);
  ASSERT_TRUE(is) << is.message();
  EXPECT_TRUE(is->has_tip());
  EXPECT_EQ(is->joints_deg_size(), 0);
}

// Whatever field of a message is missing or none of its kind.
TEST(PlayedStatus, AMessageThatIsNotWholeSaysWhichField) {
  test::DrivenMaster master(3);
  master.tick();
  KeptTick tick;
  ASSERT_TRUE(master.tap().take(tick));
  pb::RecordedTick good;
  put(tick, good);
  struct Case {
    const char* field;
    void (*spoil)(pb::RecordedTick&);
  };
  const Case cases[] = {
      {"hand", [](pb::RecordedTick& t) { t.clear_hand(); }},
      {"command", [](pb::RecordedTick& t) { t.mutable_command()->clear_command_pose(); }},
      {"command", [](pb::RecordedTick& t) { t.mutable_command()->set_command_pose(0, NAN); }},
      {"force has", [](pb::RecordedTick& t) { t.mutable_force()->RemoveLast(); }},
      {"force has", [](pb::RecordedTick& t) { t.set_force(2, INFINITY); }},
      {"wrench has", [](pb::RecordedTick& t) { t.clear_wrench(); }},
      {"motion has", [](pb::RecordedTick& t) { t.add_motion(1); }},
      {"motion_why", [](pb::RecordedTick& t) { t.clear_motion_why(); }},
      {"motion_why is 70000", [](pb::RecordedTick& t) { t.set_motion_why(0, 70000); }},
      {"joint is 6", [](pb::RecordedTick& t) { t.set_joint(6); }},
      {"reason is 4000", [](pb::RecordedTick& t) { t.set_reason(4000); }},
      {"reasons is 4000", [](pb::RecordedTick& t) { t.add_reasons(4000); }},
      {"order_says", [](pb::RecordedTick& t) { t.clear_order_says(); }},
      {"walls.hand", [](pb::RecordedTick& t) { t.mutable_walls(); }}};
  for (const Case& c : cases) {
    RecordingMoment moment;
    moment.tick = good;
    c.spoil(moment.tick);
    const auto is = played_status(master.start(), true, moment, nullptr);
    ASSERT_FALSE(is) << c.field;
    EXPECT_THAT(is.message(), HasSubstr(std::string("tick 1: ") + c.field));
  }
}

// A file is of whoever it may be: what a message says is shown or refused, and nothing else
// happens.
TEST(PlayedStatus, WhateverAMessageSaysItIsShownOrRefused) {
  Random random(4);
  for (const char* name : {"linear-movement", "gearshift"}) {
    test::DrivenMaster master(9, name);
    RecordedScenes scenes({}, "");
    ASSERT_TRUE(scenes.add(master.scenes().front()));
    KeptTick tick;
    int shown = 0, refused = 0;
    for (int i = 0; i < 10'000; ++i) {
      if (i % 5 == 0) {
        master.tick();
        ASSERT_TRUE(master.tap().take(tick));
      }
      RecordingMoment moment;
      put(tick, moment.tick);
      std::string bytes = moment.tick.SerializeAsString();
      for (std::uint64_t flips = 1 + random.bits() % 4; flips > 0; --flips) {
        char& byte = bytes[random.bits() % bytes.size()];
        byte = static_cast<char>(byte ^ (1 << random.bits() % 8));
      }
      if (!moment.tick.ParseFromString(bytes)) continue;
      const auto is = played_status(master.start(), true, moment, scenes.find(1));
      ++(is ? shown : refused);
      EXPECT_FALSE(is ? json_text(*is).empty() : is.message().empty());
    }
    EXPECT_GT(shown, 500) << name;
    EXPECT_GT(refused, 500) << name;
  }
}

}  // namespace
}  // namespace handrail
