#include "server/lab/study/linear/linear_trial.h"

#include <gtest/gtest.h>

#include "server/base/units.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

StudyMachine machine() {
  StudyMachine out;
  const auto scene = SceneLibrary().load("linear-movement");
  EXPECT_TRUE(scene) << scene.message();
  if (scene) out.scene = *scene;
  return out;
}

TrialResult run(const StudyMachine& m, const TrialOptions& options) {
  const auto result = run_linear_trial(m, options);
  EXPECT_TRUE(result) << result.message();
  return result ? *result : TrialResult();
}

TrialOptions trial(StudyMode mode, std::uint64_t seed = 1) {
  TrialOptions out;
  out.mode = mode;
  out.seed = seed;
  out.keep_trace = true;
  return out;
}

TEST(LinearTrial, ADriveEndsNearCAfterPassingB) {
  const StudyMachine m = machine();
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const TrialResult result = run(m, trial(mode));
    EXPECT_EQ(result.end, TrialEnd::kDone);
    ASSERT_GT(result.trace.size(), 500u);
    EXPECT_LT((result.trace.front().p_ST - m.scene.task->p_SA).norm(), 0.1 * kMm);
    EXPECT_LT((result.trace.back().p_ST - m.scene.task->p_SC).norm(), kOffTarget);
    double nearest_b = 1.0;
    for (const TracePoint& point : result.trace) {
      nearest_b = std::min(nearest_b, (point.p_ST - m.scene.task->p_SB).norm());
    }
    EXPECT_LT(nearest_b, kOffTarget);
    // The trace is at the robot's rate over the time measured.
    EXPECT_NEAR(static_cast<double>(result.trace.size()) * 7.1e-3, result.execution_time, 0.02);
  }
}

TEST(LinearTrial, SameArgumentsGiveTheSameBitsAndAnotherSeedDoesNot) {
  const StudyMachine m = machine();
  const TrialResult a = run(m, trial(StudyMode::kTools, 5));
  const TrialResult b = run(m, trial(StudyMode::kTools, 5));
  const TrialResult c = run(m, trial(StudyMode::kTools, 6));
  EXPECT_EQ(a.execution_time, b.execution_time);
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.position_error, b.position_error);
  EXPECT_EQ(a.orientation_error, b.orientation_error);
  EXPECT_NE(a.path, c.path);
}

// The null test: what differs between the modes is the time it takes to call tools and what the
// tools do, and nothing else.
TEST(LinearTrial, WithoutTimeToCallAndWithoutEffectToolsChangeNothing) {
  const StudyMachine m = machine();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    TrialOptions v = trial(StudyMode::kTools, seed);
    v.tools_act = false;
    v.person.call_homing = v.person.call_key = 0.0;
    TrialOptions nv = v;
    nv.mode = StudyMode::kFree;
    const TrialResult a = run(m, v);
    const TrialResult b = run(m, nv);
    EXPECT_EQ(a.execution_time, b.execution_time);
    EXPECT_EQ(a.path, b.path);
    EXPECT_EQ(a.position_error, b.position_error);
    EXPECT_EQ(a.orientation_error, b.orientation_error);
    ASSERT_EQ(a.trace.size(), b.trace.size());
    for (std::size_t i = 0; i < a.trace.size(); ++i) {
      ASSERT_EQ(a.trace[i].p_ST, b.trace[i].p_ST) << i;
    }
  }
}

TEST(LinearTrial, CallingToolsCostsItsTimeOncePerPhase) {
  const StudyMachine m = machine();
  TrialOptions v = trial(StudyMode::kTools);
  v.tools_act = false;
  v.person.vision_noise_lateral = v.person.vision_noise_depth = v.person.vision_noise_angle = 0.0;
  v.person.tremor = v.person.drift = v.person.drift_angle = v.person.motor_noise = 0.0;
  v.person.call_homing = v.person.call_key = 0.0;
  const double without = run(m, v).execution_time;
  v.person.call_homing = 0.4;
  v.person.call_key = 0.3;
  // Planning happens at fixed intervals after a phase's start: only the calls shift.
  EXPECT_NEAR(run(m, v).execution_time - without, 3 * 1.0, 0.05);
}

TEST(LinearTrial, ThePauseFallsWithPractice) {
  const StudyMachine m = machine();
  TrialOptions nv = trial(StudyMode::kFree);
  nv.person.vision_noise_lateral = nv.person.vision_noise_depth = 0.0;
  nv.person.vision_noise_angle = nv.person.motor_noise = 0.0;
  nv.person.tremor = nv.person.drift = nv.person.drift_angle = 0.0;
  nv.person.pause = 2.0;
  nv.person.practice = 0.5;
  nv.number = 1;
  const double novice = run(m, nv).execution_time;
  nv.number = 4;
  // Two pauses lie within the time measured; at the fourth trial they last half as long.
  EXPECT_NEAR(novice - run(m, nv).execution_time, 2 * 1.0, 0.05);
}

// A hand that drifts while its owner thinks makes no error of a phase: the longest pauses must not
// raise the errors found in the two short moves.
TEST(LinearTrial, ErrorsBelongToPhasesNotToThePausesBetween) {
  const StudyMachine m = machine();
  double with_pauses = 0.0, without = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    TrialOptions nv = trial(StudyMode::kFree, seed);
    nv.person.vision_noise_lateral = nv.person.vision_noise_depth = 0.0;
    nv.person.threshold = nv.person.tolerance = 6e-3;
    nv.person.drift = 1.5e-3;
    nv.person.practice = 0.0;
    nv.person.pause = 0.01;
    without += run(m, nv).position_error_on_lines;
    nv.person.pause = 20.0;
    with_pauses += run(m, nv).position_error_on_lines;
  }
  EXPECT_LT(with_pauses, 1.2 * without);
}

TEST(LinearTrial, ToolsHoldTheTipOnTheSegmentsAndTheOrientationStill) {
  const StudyMachine m = machine();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const TrialResult v = run(m, trial(StudyMode::kTools, seed));
    const TrialResult nv = run(m, trial(StudyMode::kFree, seed));
    EXPECT_LT(v.position_error_on_lines, 0.2 * nv.position_error_on_lines);
    EXPECT_LT(v.orientation_error, 0.2 * nv.orientation_error);
  }
}

// The line keeps the way, its stop is felt, and the point keeps the place.
TEST(LinearTrial, WhoHasToolsNeedsNoEyeForThePlace) {
  const StudyMachine m = machine();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    TrialOptions options = trial(StudyMode::kTools, seed);
    const double time = run(m, options).execution_time;
    options.person.vision_noise_lateral *= 3.0;
    options.person.vision_noise_depth *= 3.0;
    EXPECT_EQ(run(m, options).execution_time, time) << seed;
  }
}

TEST(LinearTrial, NobodyWhoCannotSeeTheTipSucceeds) {
  const StudyMachine m = machine();
  TrialOptions blind = trial(StudyMode::kFree);
  blind.person.vision_noise_lateral = blind.person.vision_noise_depth = 0.03;
  const TrialResult result = run(m, blind);
  EXPECT_TRUE(result.end == TrialEnd::kTimeOut || result.end == TrialEnd::kOffTarget);
  EXPECT_LE(result.execution_time, kTrialLimit + 0.01);
}

TEST(LinearTrial, WhoCallsATargetReachedFromAfarHasFailed) {
  const StudyMachine m = machine();
  int off = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    TrialOptions careless = trial(StudyMode::kFree, seed);
    careless.person.tolerance = 0.03;
    careless.person.speed = 0.1;
    const TrialResult result = run(m, careless);
    off += result.end == TrialEnd::kOffTarget;
    if (result.end == TrialEnd::kDone) {
      EXPECT_LE((result.trace.back().p_ST - m.scene.task->p_SC).norm(), 10.0 * kMm);
    }
  }
  EXPECT_GT(off, 2);
}

TEST(LinearTrial, TheArmsLagsAreTheOnesOfItsOwnSeed) {
  const StudyMachine m = machine();
  TrialOptions first = trial(StudyMode::kTools);
  TrialOptions second = first;
  second.arm_seed = first.arm_seed + 1;
  EXPECT_NE(run(m, first).position_error, run(m, second).position_error);
}

TEST(LinearTrial, SaysWhenTheSceneHasNoTaskOrThePlaceIsOutOfReach) {
  StudyMachine m = machine();
  m.scene.task->p_SA.x() = 3.0;
  EXPECT_NE(run_linear_trial(m, {}).message().find("task.a_mm"), std::string::npos);
  m.scene.task.reset();
  EXPECT_NE(run_linear_trial(m, {}).message().find("task"), std::string::npos);
}

}  // namespace
}  // namespace handrail
