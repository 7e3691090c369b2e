// One trial of the linear-movement task: a simulated operator at the whole cell, in virtual time.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/status.h"
#include "server/lab/study/study_bench.h"
#include "server/task/linear_measure.h"

namespace handrail {

enum class StudyMode : std::uint8_t { kFree, kTools };  // NV and V of the dissertation
inline constexpr int kStudyModes = 2;
const char* name_of(StudyMode mode) noexcept;

// How a trial ended. Everything but kDone is a failure.
enum class TrialEnd : std::uint8_t { kDone, kTimeOut, kOffTarget, kSession };
inline constexpr int kTrialEnds = 4;
const char* name_of(TrialEnd end) noexcept;

struct TrialOptions : TrialPlan<StudyMode> {
  bool tools_act = true;  // false: V goes through its motions, but no tool is called
};

struct TracePoint {
  Vec3 p_ST = Vec3::Zero();  // true tip [m]
  LinearPhase phase = LinearPhase::kToB;
};

// SI. Measured on the rig's true tip. The time runs from the end of the first decision pause, so
// that every tool call and the pauses between phases count, to the operator's last declaration.
struct TrialResult {
  TrialEnd end = TrialEnd::kDone;
  double execution_time = 0.0;                  // [s]
  double path = 0.0;                            // [m]
  double position_error = 0.0;                  // [m]
  double position_error_on_lines = 0.0;         // [m]
  double orientation_error = 0.0;               // [rad]
  double orientation_error_to_reference = 0.0;  // [rad]
  double orientation_error_to_nominal = 0.0;    // [rad]
  double simulated_time = 0.0;                  // of the whole run [s]
  std::vector<TracePoint> trace;                // at the robot's rate, with keep_trace
};

// What an operator tries to do in a phase, with its tools or without.
OperatorAim aim_of(const LinearTask& task, LinearPhase phase, bool tools);

// All that `measure` has, but no end, no times and no trace.
void fill_measured(const LinearMeasure& measure, TrialResult& out) noexcept;

inline constexpr double kTrialLimit = 60.0;  // a trial that takes longer has failed [s]
inline constexpr double kOffTarget = 10e-3;  // as has one that calls this far off reached [m]

// Runs one trial: the arm waits at A with the clutch closed; before each phase the operator
// decides, with tools calls them (forward-only line with a stop and N-rotation on AB and BC, the
// point at B), acts, and declares the phase done. Same arguments, same bits. `machine.scene` has a
// task; the error says why none or why the arm cannot stand at A.
Result<TrialResult> run_linear_trial(const StudyMachine& machine, const TrialOptions& options);

}  // namespace handrail
