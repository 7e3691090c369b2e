// A trial of screw fastening as master and rig tell it: when it begins, how it ends.
#include "client/experiment/screw/screw_live.h"

#include <gmock/gmock.h>

#include <fstream>

#include "server/base/units.h"
#include "server/scene/scene_library.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ScrewStage = ScrewLive::Stage;

const Scene& scene() {
  static const Scene it = *SceneLibrary().load("screw-fastening");
  return it;
}

// A cell whose rig tells a moment each millisecond.
struct Screwing {
  ScrewWork work{scene()};
  Pose start = screw_start(scene(), std::numbers::pi);
  ScrewLive live;
  ScrewTold told;
  RigSight rig;

  explicit Screwing(ScrewMode mode = ScrewMode::kCNV) : live(scene(), mode, start) {
    rig.X_ST = told.X_ST = start;
    rig.workpiece = 1;
    rig.depth = -12e-3;
    told.drives = told.clutched = true;
  }
  // `ms` pass, in each of which the key turns clockwise and rises by so much.
  void pass(int ms, double turn = 0.0, double up = 0.0) {
    for (int i = 0; i < ms; ++i) {
      ++rig.number;
      rig.time += 1e-3;
      rig.X_ST.q = rotation_exp(-turn * work.out) * rig.X_ST.q;
      rig.X_ST.p += up * work.out;
      rig.depth -= up;
      live.see(told, std::span(&rig, 1));
    }
  }
  void begin() {
    pass(10);
    live.loosened(1);
    pass(10);
    ++told.marks;
    pass(1);
    told.clutched = false;
    EXPECT_TRUE(live.timed());
  }
  void into_the_screw() {
    rig.X_ST.p = work.above(-work.depth);
    rig.depth = work.depth;
    pass(10);
  }
};

TEST(ScrewLive, TheWristGoesBackToTheStartAsItCame) {
  const Quat start = screw_start(scene(), std::numbers::pi).q, middle = screw_start(scene(), 0.0).q;
  const Vec3 out = ScrewWork(scene()).out;
  const auto next_from = [&](double clockwise) {
    return next_turn(scene(), start, rotation_exp(-clockwise * kDeg * out) * start);
  };
  // From the start on, clockwise: half a turn, and who overshoots as far again.
  for (const double clockwise : {-20.0, 0.0, 45.0, 89.0, 91.0}) {
    EXPECT_LT(angle_between(next_from(clockwise), start), 1e-9) << clockwise;
  }
  for (const double clockwise : {100.0, 180.0, 190.0, 225.0, 260.0}) {
    EXPECT_LT(angle_between(next_from(clockwise), middle), 1e-9) << clockwise;
  }
}

TEST(ScrewLive, TheClockStartsByAMarkAtTheStartWithALooseScrew) {
  Screwing it;
  EXPECT_THAT(it.live.prompt(), HasSubstr("Engage (E)"));
  it.pass(5);
  EXPECT_TRUE(it.live.waits());
  EXPECT_EQ(it.live.stage(), ScrewStage::kToStart) << "the screw is another's";
  EXPECT_EQ(it.live.prompt(), "The screw is being loosened.");
  ++it.told.marks;
  it.pass(5);
  it.live.loosened(1);
  it.pass(5);
  EXPECT_EQ(it.live.stage(), ScrewStage::kReady) << "a mark before counts for nothing";
  EXPECT_THAT(it.live.prompt(), HasSubstr("M starts the clock"));
  it.told.X_ST.p.x() += 2e-3;
  it.pass(1);
  EXPECT_EQ(it.live.stage(), ScrewStage::kToStart);
  it.told.X_ST = it.start;
  it.told.tool = true;
  it.pass(1);
  EXPECT_EQ(it.live.stage(), ScrewStage::kToStart);
  it.told.tool = false;
  ++it.told.marks;
  it.pass(1);
  EXPECT_TRUE(it.live.timed());
  EXPECT_THAT(it.live.prompt(), HasSubstr("Turned by 0 of 540 deg."));
}

TEST(ScrewLive, IsDoneWhenTheScrewIsTightAndTheKeyClear) {
  Screwing it;
  it.begin();
  it.into_the_screw();
  it.rig.turned = it.work.task.tight;
  it.rig.force.z() = 30.0;
  it.pass(1000);
  EXPECT_TRUE(it.live.timed()) << "tight, but not clear";
  EXPECT_THAT(it.live.prompt(), HasSubstr("Tight: lift the key 10 mm."));
  it.rig.force.setZero();
  it.pass(1000, 0.0, 20e-6);
  ASSERT_EQ(it.live.stage(), ScrewStage::kEnded);
  const ScrewResult& result = it.live.result();
  EXPECT_EQ(result.end, ScrewEnd::kDone);
  EXPECT_NEAR(result.completion_time, 1.010 + 0.750, 2e-3);
  EXPECT_NEAR(result.measured.max_force, 30.0, 1e-9);
  EXPECT_NEAR(result.measured.mean_force, 30.0, 1e-9);
  EXPECT_NEAR(result.measured.contact_time, 1.0, 2e-3);
  EXPECT_NEAR(result.measured.impulse, 30.0, 0.1);
  EXPECT_NEAR(it.live.rows().back().time, result.completion_time, 2e-3);
}

// Of the moments between two looks none is left out.
TEST(ScrewLive, OnePushOfAMillisecondIsTooHard) {
  Screwing it;
  it.begin();
  it.pass(100);
  std::vector<RigSight> moments;
  for (int i = 0; i < 7; ++i) {
    it.rig.time += 1e-3;
    it.rig.force.z() = i == 3 ? 501.0 : 0.0;
    moments.push_back(it.rig);
  }
  it.live.see(it.told, moments);
  ASSERT_EQ(it.live.stage(), ScrewStage::kEnded);
  EXPECT_EQ(it.live.result().end, ScrewEnd::kForce);
  EXPECT_EQ(it.live.result().measured.max_force, 501.0);
}

TEST(ScrewLive, AKeyIsLostWhereItSlipsInATurnAndNotInALift) {
  Screwing turns;
  turns.begin();
  turns.into_the_screw();
  turns.pass(500, 60e-3 * kDeg);
  turns.rig.slipped = true;
  turns.pass(1, 60e-3 * kDeg);
  ASSERT_EQ(turns.live.stage(), ScrewStage::kEnded);
  EXPECT_EQ(turns.live.result().end, ScrewEnd::kKeyLost);

  Screwing lifts;
  lifts.begin();
  lifts.into_the_screw();
  lifts.pass(500, 60e-3 * kDeg);
  lifts.pass(500);
  lifts.rig.slipped = true;
  lifts.pass(100, 0.0, 20e-6);
  EXPECT_TRUE(lifts.live.timed()) << "it was wound up, which loses nothing";

  // Who says what they do is judged by that.
  Screwing says;
  says.begin();
  says.rig.slipped = true;
  says.live.see(says.told, std::span(&says.rig, 1), ScrewPhase::kLift);
  EXPECT_TRUE(says.live.timed());
  says.live.see(says.told, std::span(&says.rig, 1), ScrewPhase::kTurn);
  EXPECT_EQ(says.live.result().end, ScrewEnd::kKeyLost);
}

TEST(ScrewLive, EndsWithTheSessionTheRigTheWorkpieceAndTheTime) {
  Screwing session;
  session.begin();
  session.told.drives = false;
  session.pass(1);
  EXPECT_EQ(session.live.result().end, ScrewEnd::kSession);
  Screwing rig;
  rig.live.lost();
  EXPECT_EQ(rig.live.stage(), ScrewStage::kToStart);
  rig.begin();
  rig.live.lost();
  EXPECT_EQ(rig.live.result().end, ScrewEnd::kSession);
  Screwing workpiece;
  workpiece.begin();
  workpiece.rig.workpiece = 2;
  workpiece.pass(1);
  EXPECT_EQ(workpiece.live.result().end, ScrewEnd::kSession);
  Screwing late;
  late.begin();
  late.pass(120'100);
  EXPECT_EQ(late.live.result().end, ScrewEnd::kTimeOut);
}

TEST(ScrewLive, ItsWayIsWrittenDown) {
  const TempFolder folder;
  const std::string file = folder.path() + "/way.csv";
  Screwing it;
  it.begin();
  it.pass(2);
  ASSERT_TRUE(write_screw_trace(file, it.live.rows()));
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("time_s,phase,tip_x_mm"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_THAT(write_screw_trace(folder.path() + "/no/way.csv", it.live.rows()).message(),
              HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace handrail
