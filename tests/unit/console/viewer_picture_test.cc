// Statuses as Foxglove's messages. What is encoded is read by names, with nothing but the schema
// that is advertised.
#include "client/console/viewer/viewer_picture.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <map>

#include "client/console/scene/scene_news.h"
#include "client/console/viewer/message_parts.h"
#include "client/console/viewer/viewer_protocol.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

constexpr Nanos kCalendar = 1'700'000'001 * kSecond + 250;

pb::SceneNews news_of(const std::string& name) {
  const auto scene = SceneLibrary().load(name);
  EXPECT_TRUE(scene) << scene.message();
  return scene_news(*scene, "", Vec2::Zero());
}

// A real master's, the arm engaged on a line.
pb::Status status_on_a_line() {
  pb::Status out;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"(state: "engaged" reason: "none" slave_state: "engaged" slave_reason: "none"
         joints_deg: -5.0461915701296105 joints_deg: 0.31088024890008226
         joints_deg: 89.76369161957406 joints_deg: 0.04205299447209249
         joints_deg: 89.9674908040289 joints_deg: -5.071419727602699
         tip { position_mm: 349.96229164212986 position_mm: -30.680268221879217
               position_mm: 428.67099099402543
               quaternion: -0.0003332764642337446 quaternion: -0.0002198142455815122
               quaternion: 0.9999998411344125 quaternion: 0.0003979191443968799 }
         desired_tip { position_mm: 349.9 position_mm: -42.9 position_mm: 430
                       quaternion: 0 quaternion: 0 quaternion: 1 quaternion: 0 }
         hand { position_mm: 20.46 position_mm: 1.21 position_mm: 0.11
                quaternion: 1 quaternion: 0 quaternion: 0 quaternion: 0 }
         position_tool { kind: "line" geometry {
           anchor_mm: 350 anchor_mm: 0 anchor_mm: 428.6 direction: 0 direction: -1 direction: 0
           end_mm: 350 end_mm: -75 end_mm: 428.6 one_way: true } }
         orientation_tool { kind: "n-rotation" geometry {
           quaternion: 0 quaternion: 0 quaternion: 1 quaternion: 0 } }
         tool_force { force_n: 0.5 force_n: 0 force_n: 0 }
         spring_force { force_n: 0 force_n: 0 force_n: 0.01 }
         has_contact_force: true contact_force_n: 0 contact_force_n: 0 contact_force_n: 30
         haptic { max_force_n: 3.3 })",
      &out));
  return out;
}

// Builds the type from its advertised schema alone, and reads the bytes with it.
std::string read_back(const google::protobuf::Message& message) {
  const pb::ViewerChannel channel = viewer_channel(1, "/x", *message.GetDescriptor());
  google::protobuf::FileDescriptorSet files;
  EXPECT_TRUE(files.ParseFromString(channel.schema()));
  google::protobuf::DescriptorPool pool;
  for (const auto& file : files.file()) pool.BuildFile(file);
  google::protobuf::DynamicMessageFactory factory(&pool);
  const auto* type = pool.FindMessageTypeByName(channel.schema_name());
  if (type == nullptr) {
    ADD_FAILURE() << channel.schema_name() << " cannot be built";
    return "";
  }
  const std::unique_ptr<google::protobuf::Message> read(factory.GetPrototype(type)->New());
  EXPECT_TRUE(read->ParseFromString(message.SerializeAsString()));
  return read->ShortDebugString();
}

Pose pose_of_transform(const foxglove::FrameTransform& t) {
  return {Vec3(t.translation().x(), t.translation().y(), t.translation().z()),
          Quat(t.rotation().w(), t.rotation().x(), t.rotation().y(), t.rotation().z())};
}

// Where a frame is in the world, up its parents.
Pose in_world(const foxglove::FrameTransforms& frames, const std::string& name) {
  if (name == "world") return {};
  for (const auto& each : frames.transforms()) {
    if (each.child_frame_id() != name) continue;
    return in_world(frames, each.parent_frame_id()) * pose_of_transform(each);
  }
  ADD_FAILURE() << "no frame " << name;
  return {};
}

std::vector<std::string> names_of(const foxglove::FrameTransforms& frames) {
  std::vector<std::string> out;
  for (const auto& each : frames.transforms()) out.push_back(each.child_frame_id());
  return out;
}

const foxglove::SceneEntity& entity(const foxglove::SceneUpdate& update, const std::string& id) {
  static const foxglove::SceneEntity none;
  for (const auto& each : update.entities()) {
    if (each.id() == id) return each;
  }
  ADD_FAILURE() << "no entity " << id;
  return none;
}

// Where an arrow ends.
Vec3 end_of(const foxglove::ArrowPrimitive& arrow) {
  const auto& p = arrow.pose().position();
  const auto& q = arrow.pose().orientation();
  const Vec3 x = Quat(q.w(), q.x(), q.y(), q.z()) * Vec3::UnitX();
  return Vec3(p.x(), p.y(), p.z()) + (arrow.shaft_length() + arrow.head_length()) * x;
}

TEST(ViewerPicture, TheLinksLeadToTheTipThatWasMeasured) {
  const pb::SceneNews scene = news_of("linear-movement");
  const auto frames = frame_transforms(status_on_a_line(), scene, kCalendar);
  const Pose flange = in_world(frames, "flange"), tip = in_world(frames, "tip");
  const double beyond = kMm * (scene.arm().tip_mm() - scene.arm().flange_mm());
  EXPECT_NEAR((flange.p + beyond * (flange.q * Vec3::UnitZ()) - tip.p).norm(), 0.0, 1e-5);
  EXPECT_LT(flange.q.angularDistance(tip.q), 1e-3);
  EXPECT_NEAR(tip.p.x(), 0.34996229, 1e-8);
  EXPECT_NEAR(in_world(frames, "ghost").p.y(), -0.0429, 1e-12);
  // Right at the device is -Y of the arm in this scene.
  EXPECT_NEAR(in_world(frames, "hand").p.y(), -0.02046, 1e-12);
  EXPECT_EQ(frames.transforms(0).timestamp().seconds(), 1'700'000'001);
  EXPECT_EQ(frames.transforms(0).timestamp().nanos(), 250);
}

TEST(ViewerPicture, WhatAStatusDoesNotHaveIsLeftOut) {
  const auto frames = frame_transforms(pb::Status(), news_of("linear-movement"), kCalendar);
  EXPECT_THAT(names_of(frames), ::testing::ElementsAre("base", "device"));
  pb::PoseMm half;
  half.add_position_mm(1.0);
  EXPECT_FALSE(pose_in_frame(half, kCalendar).has_pose());
  const auto none = marks(pb::Status(), news_of("linear-movement"), kCalendar);
  EXPECT_EQ(entity(none, "forces").arrows_size(), 0);
  EXPECT_EQ(entity(none, "position tool").arrows_size(), 0);
}

TEST(ViewerPicture, WallsLieAsTheirStageSays) {
  pb::SceneNews scene = news_of("gearshift");
  pb::SceneMap::Stage& stage = *scene.mutable_map()->mutable_stage(0);
  stage.clear_at_mm();
  stage.add_at_mm(10);
  stage.add_at_mm(5);
  stage.set_turn_deg(90);
  pb::Status status;
  status.mutable_walls()->set_stage(0);
  const auto frames = frame_transforms(status, scene, kCalendar);
  EXPECT_THAT(names_of(frames), Not(IsSupersetOf({"base"})));
  const Pose walls = in_world(frames, "walls");
  EXPECT_NEAR((walls.q * Vec3(0.003, 0.0, 0.0) + walls.p - Vec3(0.010, 0.008, 0.0)).norm(), 0.0,
              1e-12);
  status.mutable_walls()->set_stage(99);
  EXPECT_TRUE(in_world(frame_transforms(status, scene, kCalendar), "walls").p.isZero());
}

TEST(ViewerPicture, JointsAreInRadiansAndPosesInMetres) {
  const pb::Status status = status_on_a_line();
  const auto joints = joint_states(status, kCalendar);
  EXPECT_THAT(read_back(joints), HasSubstr("timestamp { seconds: 1700000001 nanos: 250 } joints { "
                                           "name: \"J1\" position: -0.0880726"));
  EXPECT_EQ(joints.joints_size(), 6);
  EXPECT_THAT(read_back(pose_in_frame(status.desired_tip(), kCalendar)),
              HasSubstr("frame_id: \"base\" pose { position { x: 0.3499 y: -0.0429 z: 0.43 } "
                        "orientation { y: 1 } }"));
}

TEST(ViewerPicture, ALineIsAnArrowFromItsStartToItsEnd) {
  const auto drawn = marks(status_on_a_line(), news_of("linear-movement"), kCalendar);
  const auto& line = entity(drawn, "position tool");
  ASSERT_EQ(line.arrows_size(), 1) << "one way";
  EXPECT_NEAR((end_of(line.arrows(0)) - Vec3(0.350, -0.075, 0.4286)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(line.arrows(0).pose().position().y(), 0.0, 1e-12);
  EXPECT_TRUE(line.frame_locked());
  EXPECT_EQ(entity(drawn, "orientation tool").arrows_size(), 3);
  EXPECT_THAT(read_back(drawn), HasSubstr("frame_id: \"base\" id: \"position tool\""));
}

TEST(ViewerPicture, APlaneAPointAndAnAxisAreDrawnWhereTheyConstrain) {
  pb::Status status = status_on_a_line();
  pb::ToolStatus& tool = *status.mutable_position_tool();
  tool.set_kind("plane");
  tool.mutable_geometry()->clear_direction();
  for (const double v : {0.0, 1.0, 0.0}) tool.mutable_geometry()->add_normal(v);
  const pb::SceneNews scene = news_of("linear-movement");
  const auto plane = marks(status, scene, kCalendar);
  const auto& sheet = entity(plane, "position tool").cubes(0);
  const auto& q = sheet.pose().orientation();
  EXPECT_NEAR((Quat(q.w(), q.x(), q.y(), q.z()) * Vec3::UnitZ() - Vec3::UnitY()).norm(), 0.0, 1e-9);
  EXPECT_LT(sheet.size().z(), 0.001);
  tool.set_kind("point");
  status.mutable_orientation_tool()->set_kind("f-rotation");
  for (const double v : {0.0, 0.0, 1.0}) {
    status.mutable_orientation_tool()->mutable_geometry()->add_axis(v);
  }
  const auto point = marks(status, scene, kCalendar);
  EXPECT_NEAR(entity(point, "position tool").spheres(0).pose().position().z(), 0.4286, 1e-12);
  ASSERT_EQ(entity(point, "orientation tool").arrows_size(), 1);
  EXPECT_NEAR(end_of(entity(point, "orientation tool").arrows(0)).z(), 0.42867099 + 0.090, 1e-6);
}

TEST(ViewerPicture, ForcesAreArrowsAtTheTipAsLongAsThePages) {
  const auto drawn = marks(status_on_a_line(), news_of("linear-movement"), kCalendar);
  const auto& forces = entity(drawn, "forces");
  ASSERT_EQ(forces.arrows_size(), 2) << "the spring's 10 mN are noise";
  const Vec3 tip(0.34996229, -0.03068027, 0.42867099);
  // 0.5 N of 3.3, which are 110 mm, to the right of the hand; 30 N at 2 mm each, up.
  EXPECT_NEAR((end_of(forces.arrows(0)) - tip - Vec3(0.0, -0.11 * 0.5 / 3.3, 0.0)).norm(), 0.0,
              1e-7);
  EXPECT_NEAR((end_of(forces.arrows(1)) - tip - Vec3(0.0, 0.0, 0.060)).norm(), 0.0, 1e-7);
}

TEST(ViewerPicture, OfWallsTheForceIsAtTheHandAndTheProxyInTheirFrame) {
  pb::Status status;
  for (const double v : {-32.0, 17.0, 0.0}) status.mutable_hand()->add_position_mm(v);
  for (const double v : {1.0, 0.0, 0.0, 0.0}) status.mutable_hand()->add_quaternion(v);
  for (const double v : {-3.3, 0.0, 0.0}) status.mutable_device_force()->add_force_n(v);
  for (const double v : {-33.0, 17.0}) status.mutable_walls()->add_proxy_mm(v);
  const auto drawn = marks(status, news_of("gearshift"), kCalendar);
  ASSERT_EQ(drawn.entities_size(), 2);
  EXPECT_EQ(entity(drawn, "force at the hand").frame_id(), "device");
  EXPECT_NEAR(end_of(entity(drawn, "force at the hand").arrows(0)).x(), -0.032 - 0.110, 1e-9);
  EXPECT_EQ(entity(drawn, "proxy").frame_id(), "walls");
  EXPECT_NEAR(entity(drawn, "proxy").spheres(0).pose().position().x(), -0.033, 1e-12);
}

TEST(ViewerPicture, TheCellHasArmWorkPiecesAndGoalsAndTakesAwayWhatWasThere) {
  const auto cell = work_cell(news_of("linear-movement"), kCalendar);
  ASSERT_EQ(cell.deletions_size(), 1);
  EXPECT_EQ(cell.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  EXPECT_EQ(entity(cell, "goals").spheres_size(), 3);
  EXPECT_NEAR(entity(cell, "arm upper").cylinders(0).size().z(), 0.250, 1e-12);
  EXPECT_EQ(entity(cell, "arm upper").frame_id(), "link_2");
  EXPECT_THAT(read_back(cell), HasSubstr("deletions { timestamp { seconds: 1700000001"));
  pb::SceneNews bodies = news_of("linear-movement");
  bodies.clear_body();
  for (const auto kind : {pb::SceneBody::PLANE, pb::SceneBody::BOX, pb::SceneBody::CYLINDER,
                          pb::SceneBody::TUBE, pb::SceneBody::SOCKET}) {
    pb::SceneBody& body = *bodies.add_body();
    body.set_kind(kind);
    for (const double v : {100.0, 0.0, 50.0}) body.mutable_pose()->add_position_mm(v);
    for (const double v : {1.0, 0.0, 0.0, 0.0}) body.mutable_pose()->add_quaternion(v);
    for (const double v : {10.0, 20.0, 30.0}) body.add_size_mm(v);
  }
  const auto drawn = work_cell(bodies, kCalendar);
  const auto& pieces = entity(drawn, "work pieces");
  ASSERT_EQ(pieces.cubes_size(), 2);
  ASSERT_EQ(pieces.cylinders_size(), 3);
  EXPECT_NEAR(pieces.cubes(1).size().z(), 0.030, 1e-12);
  EXPECT_NEAR(pieces.cylinders(0).size().x(), 0.020, 1e-12) << "of a radius";
  EXPECT_NEAR(pieces.cylinders(2).pose().position().z(), 0.040, 1e-12) << "below its rim";
  EXPECT_EQ(work_cell(news_of("gearshift"), kCalendar).entities_size(), 0);
}

TEST(ViewerPicture, AMapIsAGridAboutItsMiddle) {
  MapCells cells;
  cells.columns = 2;
  cells.rows = 1;
  cells.size = Vec2(0.2, 0.1);
  cells.rgb = "abcdef";
  const std::string grid = read_back(map_grid(cells, kCalendar));
  EXPECT_THAT(grid, HasSubstr("frame_id: \"walls\" pose { position { x: -0.1 y: -0.05"));
  EXPECT_THAT(grid, HasSubstr("column_count: 2 cell_size { x: 0.1 y: 0.1 } row_stride: 8 "
                              "cell_stride: 4"));
  EXPECT_THAT(grid, HasSubstr("name: \"alpha\" offset: 3 type: UINT8"));
  EXPECT_THAT(grid, HasSubstr("data: \"abc\\377def\\377\""));
}

TEST(ViewerPicture, ALineOfTheLogHasTheReasonOfBothSidesAndItsLevel) {
  pb::Reply reply;
  *reply.mutable_status() = status_on_a_line();
  EXPECT_EQ(log_line(reply, kCalendar).message(), "engaged; arm engaged");
  EXPECT_EQ(log_line(reply, kCalendar).level(), foxglove::Log::INFO);
  reply.mutable_status()->set_slave_reason("a joint is at the end of its range");
  EXPECT_EQ(log_line(reply, kCalendar).level(), foxglove::Log::WARNING);
  EXPECT_THAT(read_back(log_line(reply, kCalendar)),
              HasSubstr("message: \"engaged; arm engaged: a joint is at the end of its range\""));
  reply.mutable_status()->set_slave_state("fault");
  EXPECT_EQ(log_line(reply, kCalendar).level(), foxglove::Log::ERROR);
  reply.mutable_status()->set_state("off");
  reply.mutable_status()->set_reason("not engaged");
  reply.mutable_status()->set_slave_state("off");
  reply.mutable_status()->set_slave_reason("not engaged");
  EXPECT_EQ(log_line(reply, kCalendar).level(), foxglove::Log::INFO);
}

TEST(ViewerPicture, AnEventSaysInASentenceWhatChanged) {
  ViewerFacts was;
  was.answers = true;
  was.state = "off";
  was.scene = "gearshift, stage low";
  ViewerFacts is = was;
  EXPECT_TRUE(events_between(was, is, kCalendar).empty());
  is.holder = "ann";
  is.scene = "gearshift, stage high";
  auto events = events_between(was, is, kCalendar);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].text(), "ann has the lease");
  EXPECT_EQ(events[1].text(), "the scene is gearshift, stage high");
  EXPECT_THAT(read_back(events[1]), HasSubstr("kind: SCENE"));
  events = events_between(is, was, kCalendar);
  EXPECT_EQ(events[0].text(), "nobody has the lease");
  is = was;
  is.reason = "a joint is at the end of its range";
  EXPECT_TRUE(events_between(was, is, kCalendar).empty()) << "that is for the log";
}

}  // namespace
}  // namespace handrail
