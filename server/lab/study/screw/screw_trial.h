// One trial of the screw-fastening task: a simulated operator at the whole cell, in virtual time.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/status.h"
#include "server/lab/study/study_bench.h"
#include "server/model/bumper_settings.h"
#include "server/task/screw_measure.h"

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

// How a trial ended. Everything but kDone is a failure.
enum class ScrewEnd : std::uint8_t { kDone, kForce, kKeyLost, kTimeOut, kSession };
const char* name_of(ScrewEnd end) noexcept;

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

inline constexpr double kScrewLimit = 120.0;  // a trial that takes longer has failed [s]
inline constexpr double kTooHard = 500.0;     // as has one that pushes harder [N]

// Runs one trial. The key waits beside and above the socket with the clutch closed. Until the
// screw is tight the operator inserts the ball end, turns clockwise about half a turn, lifts the
// key and turns back. With tools: a line along the screw's axis throughout, with N-rotation while
// inserting and F-rotation while turning, lifting and turning back. Same arguments, same bits.
// `machine.scene` has a screw task; the error says why none or what the arm cannot reach.
Result<ScrewResult> run_screw_trial(const StudyMachine& machine, const ScrewTrialOptions& options);

}  // namespace handrail
