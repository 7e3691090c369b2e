// Gearshift and wrench, as people make them at a master that says where the lever is.
#include <gmock/gmock.h>

#include <cmath>

#include "client/experiment/gearshift_experiment.h"
#include "client/experiment/wrench_experiment.h"
#include "server/base/units.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kMoment = 0.007;  // between two statuses [s]

// The master as it would tell of a lever that is put somewhere.
class WallTaskTest : public ::testing::Test {
 protected:
  explicit WallTaskTest(const char* name) : scene(*SceneLibrary().load(name)) {
    status.set_scene(name);
    status.set_scene_epoch(1);
    status.set_time_s(1000.0);
    status.mutable_haptic()->mutable_cursor()->set_held(true);
    status.mutable_walls();
  }
  void begin(ExperimentTask& task) { trial = task.begin({0, false, 3, 1}); }
  // A moment with the lever at `p`, `into` beyond a wall, pushed by `force`.
  void moment(ExperimentTask& task, const Vec2& p, double force = 0.0, double into = 0.0) {
    pb::WallStatus& walls = *status.mutable_walls();
    walls.set_touching(into > 0.0);
    set(walls.mutable_proxy_mm(), p / kMm);
    set(walls.mutable_hand_mm(), (p + Vec2(into, 0.0)) / kMm);
    set(walls.mutable_force_n(), Vec2(0.0, -force));
    status.set_time_s(status.time_s() + kMoment);
    task.see(&status);
    task.act(status, {[&](pb::Request request) {
                        orders.push_back(request);
                        return order_answer;
                      },
                      [&](const std::string& text) { said += text + '\n'; }});
  }
  static void set(google::protobuf::RepeatedField<double>* out, const Vec2& v) {
    out->Clear();
    out->Add(v.x());
    out->Add(v.y());
  }
  const pb::WallTrial& result(const ExperimentTask& task) {
    task.fill(trial);
    return trial.walls();
  }

  Scene scene;
  pb::Status status;
  pb::ExperimentTrial trial;
  std::vector<pb::Request> orders;
  Status order_answer = Status::ok();
  std::string said;
};

class GearshiftExperimentTest : public WallTaskTest {
 protected:
  GearshiftExperimentTest()
      : WallTaskTest("gearshift"), gate(*GearGate::of(scene)), task(scene, gate) {
    begin(task);
  }
  // Along the aisles, as fast as the lock lets.
  void go(const Vec2& to) {
    const std::vector<Vec2> way = gate.way(lever, to);
    for (std::size_t i = 1; i < way.size(); ++i) {
      const Vec2& from = way[i - 1];
      for (int k = 1; k <= 20 && !task.ended(); ++k) at(from + (way[i] - from) * k / 20.0);
    }
  }
  void at(const Vec2& p, double force = 0.0, double into = 0.0) {
    lever = p;
    status.mutable_walls()->set_locked(false);
    status.mutable_walls()->clear_place();
    for (std::size_t i = 0; i < gate.places().size(); ++i) {
      if ((p - gate.places()[i]).norm() > 4e-3) continue;
      status.mutable_walls()->set_locked(true);
      status.mutable_walls()->set_place(gate.names()[i]);
    }
    moment(task, p, force, into);
  }
  void gear(const std::string& name) {
    const auto& names = gate.names();
    go(gate.places()[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                              names.begin())]);
  }
  void rest() {
    for (int i = 0; i < 100 && !task.ended(); ++i) at(lever);
  }
  std::string prompt() const { return task.prompt().text; }

  GearGate gate;
  GearshiftExperiment task;
  Vec2 lever = Vec2::Zero();
};

TEST_F(GearshiftExperimentTest, SaysWhichGearIsNextAndIsDoneAtRestInNeutral) {
  at(Vec2(0.02, 0.0));
  EXPECT_EQ(prompt(), "Bring the lever to N, in the middle.");
  go(gate.neutral());
  rest();
  EXPECT_EQ(prompt(), "In N. The clock starts as the lever leaves it: to 1.");
  const double before = status.time_s();
  std::string last;
  for (const std::string& name : gate.names()) {
    gear(name);
    EXPECT_FALSE(task.ended());
    if (name != "R") {
      EXPECT_THAT(prompt(), HasSubstr(name + " is in. Now ")) << name;
    }
    last = name;
  }
  EXPECT_EQ(prompt(), "Back to N, and rest there.");
  go(gate.neutral());
  EXPECT_FALSE(task.ended()) << "it does not rest yet";
  rest();
  ASSERT_TRUE(task.ended());
  const pb::WallTrial& done = result(task);
  EXPECT_EQ(done.end(), "done");
  EXPECT_EQ(done.number(), 3u);
  EXPECT_THAT(done.visited(), ElementsAre("N", "1", "2", "3", "4", "5", "R", "N"));
  EXPECT_EQ(done.wrong_gears(), 0u);
  // The clock starts when the lever is 4 mm out of N, which is within two moments here.
  EXPECT_NEAR(done.time_s(), status.time_s() - before, 3 * kMoment);
  EXPECT_FALSE(done.has_mean_wall_force_n()) << "no wall was touched";
  EXPECT_THAT(task.outcome(), HasSubstr("N-1-2-3-4-5-R-N"));
}

TEST_F(GearshiftExperimentTest, AGearOutOfTurnIsSaidAndCountedAndThePersonGoesOn) {
  go(gate.neutral());
  gear("1");
  gear("4");
  EXPECT_EQ(prompt(), "4 is the wrong gear. Now 2.");
  gear("2");
  EXPECT_EQ(prompt(), "2 is in. Now 3.");
  // Rest in N on the way, and the same gear again, are no gears out of turn.
  go(gate.neutral());
  rest();
  gear("3");
  EXPECT_EQ(prompt(), "3 is in. Now 4.");
  go(gate.neutral());
  for (const char* name : {"3", "4", "5", "R"}) gear(name);
  go(gate.neutral());
  rest();
  ASSERT_TRUE(task.ended());
  EXPECT_EQ(result(task).end(), "done");
  EXPECT_EQ(result(task).wrong_gears(), 1u);
  EXPECT_THAT(result(task).visited(),
              ElementsAre("N", "1", "4", "2", "3", "3", "4", "5", "R", "N"));
}

TEST_F(GearshiftExperimentTest, ForcesAndDistancesAreThoseOfTheTimedPart) {
  at(gate.neutral(), 20.0, 3e-3);  // before the clock runs
  at(gate.neutral());
  at(Vec2(0.02, 0.0));
  at(Vec2(0.02, 0.0), 8.0, 1.5e-3);
  at(Vec2(0.02, 0.0), 4.0, 0.5e-3);
  at(Vec2(0.02, 0.0), 9.0);  // a lock's pull, no wall
  EXPECT_NEAR(result(task).max_wall_force_n(), 8.0, 1e-9);
  EXPECT_NEAR(result(task).mean_wall_force_n(), 6.0, 1e-9);
  EXPECT_NEAR(result(task).max_force_n(), 9.0, 1e-9);
  EXPECT_NEAR(result(task).max_hand_from_lever_mm(), 1.5, 1e-9);
}

TEST_F(GearshiftExperimentTest, NobodyHoldsTheLeverNoClockStarts) {
  status.mutable_haptic()->mutable_cursor()->set_held(false);
  at(gate.neutral());
  EXPECT_THAT(prompt(), HasSubstr("Hold the lever. "));
  status.mutable_haptic()->mutable_cursor()->set_held(true);
  at(Vec2(0.02, 0.0));
  EXPECT_EQ(prompt(), "Bring the lever to N, in the middle.");
  go(gate.neutral());
  status.mutable_haptic()->mutable_cursor()->set_held(false);
  gear("1");
  EXPECT_EQ(prompt(), "Hold the lever. Bring the lever to N, in the middle.");
}

TEST_F(GearshiftExperimentTest, AMasterThatIsGoneAndASceneLoadedAnewEndTheTrial) {
  task.see(nullptr);
  EXPECT_FALSE(task.ended()) << "the clock does not run";
  at(gate.neutral());
  gear("1");
  task.see(nullptr);
  ASSERT_TRUE(task.ended());
  EXPECT_EQ(result(task).end(), "session lost");
  begin(task);
  EXPECT_FALSE(task.ended());
  at(gate.neutral());
  gear("1");
  status.set_scene_epoch(2);
  at(lever);
  ASSERT_TRUE(task.ended());
  EXPECT_EQ(result(task).end(), "session lost");
}

TEST_F(GearshiftExperimentTest, WhoTakesTooLongHasFailed) {
  at(gate.neutral());
  gear("1");
  while (!task.ended() && status.time_s() < 1000.0 + 2 * kWallLimit) at(lever);
  EXPECT_EQ(result(task).end(), "time-out");
  EXPECT_NEAR(result(task).time_s(), kWallLimit, 2 * kMoment);
}

class WrenchExperimentTest : public WallTaskTest {
 protected:
  explicit WrenchExperimentTest(WrenchWay way = WrenchWay::kTighten)
      : WallTaskTest("wrench"), path(*WrenchPath::of(scene)), task(scene, path, way) {
    status.mutable_walls()->set_screw_c(5.0);
    status.mutable_walls()->set_turned_rad(0.0);
    begin(task);
  }
  // The lever is always `behind` the ball, as seen in the moment before.
  void follow(double seconds, const Vec2& behind = Vec2::Zero()) {
    for (double t = 0.0; t < seconds && !task.ended(); t += kMoment) {
      moment(task, *task.prompt().ball + behind);
    }
  }
  WrenchPath path;
  WrenchExperiment task;
};

TEST_F(WrenchExperimentTest, TheBallLeadsTwoLoopsOfSixSecondsEach) {
  const Vec2 begins = *task.prompt().ball;
  moment(task, Vec2(0.03, 0.0));
  EXPECT_EQ(task.prompt().text, "Bring the lever to the ball.");
  follow(0.9);
  EXPECT_EQ(task.prompt().text, "The ball sets out in a second: follow it.");
  EXPECT_EQ(*task.prompt().ball, begins);
  follow(2.0);
  EXPECT_EQ(task.prompt().text, "Follow the ball: loop 1 of 2.");
  EXPECT_GT((*task.prompt().ball - begins).norm(), 0.01);
  follow(7.0);
  EXPECT_EQ(task.prompt().text, "Follow the ball: loop 2 of 2.");
  status.mutable_walls()->set_turned_rad(6.4);
  follow(20.0);
  ASSERT_TRUE(task.ended());
  const pb::WallTrial& done = result(task);
  EXPECT_EQ(done.end(), "done");
  const double way_in = 0.5 * (path.length() - path.turn_length()) / path.speed();
  EXPECT_NEAR(done.time_s(), 2 * kLoopTime + way_in, 3 * kMoment);
  EXPECT_EQ(done.turned_rad(), 6.4);
  EXPECT_EQ(done.screw_c(), 5.0);
  // The ball moves on by a moment's way.
  EXPECT_LT(done.max_from_ball_mm(), 1.0);
  EXPECT_TRUE(orders.empty()) << "a loose screw needs no loosening";
}

TEST_F(WrenchExperimentTest, HowFarTheHandIsFromTheBallIsMeasured) {
  follow(1.1);
  follow(20.0, Vec2(0.0, -4e-3));
  ASSERT_TRUE(task.ended());
  EXPECT_NEAR(result(task).mean_from_ball_mm(), 4.0, 0.5);
  EXPECT_GE(result(task).max_from_ball_mm(), result(task).mean_from_ball_mm());
}

TEST_F(WrenchExperimentTest, WhoFallsBehindIsWaitedFor) {
  follow(2.0);
  const Vec2 stays = *task.prompt().ball;
  for (int i = 0; i < 1000; ++i) moment(task, stays);
  EXPECT_LT((*task.prompt().ball - stays).norm(), 1.1 * kBallAhead);
  EXPECT_FALSE(task.ended());
}

TEST_F(WrenchExperimentTest, AScrewThatWasTurnedIsLoosenedByLoadingTheSceneAnew) {
  status.mutable_walls()->set_turned_rad(6.4);
  order_answer = Status::error("refused: busy");
  moment(task, Vec2::Zero());
  moment(task, Vec2::Zero());
  ASSERT_EQ(orders.size(), 1u) << "not with every status";
  EXPECT_EQ(orders[0].scene_load(), "wrench");
  EXPECT_EQ(said, "  the screw is not made ready: refused: busy\n");
  follow(3.0);
  EXPECT_EQ(task.prompt().text, "The screw is being made ready.");
  status.set_scene_epoch(2);
  status.mutable_walls()->set_turned_rad(0.0);
  follow(2.0);
  EXPECT_THAT(task.prompt().text, HasSubstr("Follow the ball"));
}

// As a person left it, or the other experiment.
TEST_F(WrenchExperimentTest, AScrewOfAnotherGrowthIsMadeAsTheSceneHasIt) {
  status.mutable_walls()->set_screw_c(15.0);
  follow(3.0);
  EXPECT_EQ(task.prompt().text, "The screw is being made ready.");
  ASSERT_FALSE(orders.empty());
  EXPECT_EQ(orders[0].screw_c(), 5.0);
  status.mutable_walls()->set_screw_c(5.0);
  follow(2.0);
  EXPECT_THAT(task.prompt().text, HasSubstr("Follow the ball"));
  // While the clock runs it is the person's to change.
  orders.clear();
  status.mutable_walls()->set_screw_c(15.0);
  follow(1.0);
  EXPECT_TRUE(orders.empty());
}

class LooseningTest : public WrenchExperimentTest {
 protected:
  LooseningTest() : WrenchExperimentTest(WrenchWay::kTightenAndLoosen) {}
};

TEST_F(LooseningTest, TheBallLeadsTwoLoopsAndTwoBackAtAnotherGrowth) {
  follow(2.0);
  EXPECT_EQ(task.prompt().text, "The screw is being made ready.");
  ASSERT_FALSE(orders.empty());
  EXPECT_EQ(orders[0].screw_c(), kLooseningC);
  status.mutable_walls()->set_screw_c(kLooseningC);
  follow(1.5);
  EXPECT_EQ(task.prompt().text, "Follow the ball: loop 1 of 2.");
  follow(14.0);
  EXPECT_EQ(task.prompt().text, "Follow the ball back: loop 1 of 2.");
  status.mutable_walls()->set_turned_rad(0.1);
  follow(40.0);
  ASSERT_TRUE(task.ended());
  EXPECT_EQ(result(task).end(), "done");
  const double way_in = 0.5 * (path.length() - path.turn_length()) / path.speed();
  EXPECT_NEAR(result(task).time_s(), 4 * kLoopTime + way_in, 3 * kMoment);
  EXPECT_EQ(result(task).screw_c(), kLooseningC);
}

TEST_F(WrenchExperimentTest, TheBallDoesNotSetOutBeforeTheLeverWasHeldThereForASecond) {
  follow(0.9);
  moment(task, Vec2(0.02, 0.0));
  follow(0.9);
  EXPECT_EQ(task.prompt().text, "The ball sets out in a second: follow it.");
  status.mutable_haptic()->mutable_cursor()->set_held(false);
  follow(3.0);
  EXPECT_EQ(task.prompt().text, "Hold the lever. Bring the lever to the ball.");
}

}  // namespace
}  // namespace handrail
