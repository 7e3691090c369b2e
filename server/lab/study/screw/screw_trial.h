// One trial of the screw-fastening task: a simulated operator at the whole cell, in virtual time.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/status.h"
#include "server/lab/study/screw/screw_judge.h"
#include "server/lab/study/study_bench.h"
#include "server/model/bumper_settings.h"

namespace handrail {

// Contact protection, which is bumper and virtual spring, and virtual tools, each without (N) and
// with. Names and order of the dissertation.
enum class ScrewMode : std::uint8_t { kNCNV, kNCV, kCNV, kCV };
inline constexpr int kScrewModes = 4;
const char* name_of(ScrewMode mode) noexcept;  // "NC-NV"
constexpr bool has_tools(ScrewMode mode) noexcept {
  return mode == ScrewMode::kNCV || mode == ScrewMode::kCV;
}
constexpr bool has_protection(ScrewMode mode) noexcept {
  return mode == ScrewMode::kCNV || mode == ScrewMode::kCV;
}

// What the modes are made of: without protection the bumper is off and the virtual spring has no
// force.
void set_protection(bool protection, Scene& scene) noexcept;

// Where the key waits, beside and above the socket, turned back by half of a half turn [rad]. Of a
// scene with a screw task.
Pose screw_start(const Scene& scene, double half_turn) noexcept;

struct ScrewTrialOptions : TrialPlan<ScrewMode> {
  BumperSettings::Form bumper = BumperSettings::Form::kDefault;  // in the modes with protection
};

struct ScrewTracePoint {
  double time = 0.0;  // [s]
  ScrewPhase phase = ScrewPhase::kAlign;
  Vec3 p_ST = Vec3::Zero();     // true tip [m]
  Vec3 contact = Vec3::Zero();  // what the screw exerts on the tip, S [N]
  Vec3 spring = Vec3::Zero();   // of the virtual spring on the hand, S [N]
};

// SI. The time runs from the end of the first decision pause until the screw is tight and the key
// clear, measured on the rig's true tip and contact force.
struct ScrewResult {
  ScrewEnd end = ScrewEnd::kDone;
  double completion_time = 0.0;  // [s]
  ScrewMeasured measured;
  int misses = 0;                      // insertions that had to be tried again
  double simulated_time = 0.0;         // of the whole run [s]
  std::vector<ScrewTracePoint> trace;  // at the robot's rate, with keep_trace
};

// Runs one trial: the key waits as screw_start() says with the clutch closed, and the operator does
// what ScrewPerson does. Same arguments, same bits. `machine.scene` has a screw task; the error
// says why none or what the arm cannot reach.
Result<ScrewResult> run_screw_trial(const StudyMachine& machine, const ScrewTrialOptions& options);

}  // namespace handrail
