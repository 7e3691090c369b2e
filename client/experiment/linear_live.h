// The linear-movement task as somebody makes it at the running programs, step by step.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/study/linear/linear_trial.h"
#include "server/task/linear_measure.h"

namespace handrail {

// What the master says at one moment.
struct LiveSample {
  Pose X_ST;                          // the tip, measured
  Quat q_command = Quat::Identity();  // the orientation commanded
  bool drives = false;                // the hand leads the arm, or a clutch or the link holds it
  bool clutched = false;
  bool position_tool = false, orientation_tool = false;  // is called
  const char* frees = "C";  // what lets the arm follow the hand after the clutch
  bool lets_go = false;     // the hand has to be let go before that
  std::uint64_t marks = 0;  // set so far
  double marked = 0.0;      // when the newest was [s]
  double time = 0.0;        // now, on the same clock [s]
};

// One trial, from wherever the tip is. With the arm at A and the clutch closed a mark starts the
// clock, each further one says that B, the turn and C are reached, as the simulated operators
// declare it; the same code judges. A mark elsewhere than at A, before the clock runs, counts for
// nothing. Errors of a phase are taken from its mark on; with tools from when they are called, as
// calling them is no part of it.
class LinearLive {
 public:
  enum class Stage : std::uint8_t { kToA, kAtA, kToB, kTurn, kToC, kEnded };

  LinearLive(const LinearTask& task, StudyMode mode) noexcept
      : task_(task), mode_(mode), measure_(task), at_mark_(task) {}

  void see(const LiveSample& now);

  Stage stage() const { return stage_; }
  // What the person is to do, in a line.
  std::string prompt() const;
  // The phase that runs, of the stages between A and C.
  LinearPhase phase() const;
  // Once it has ended; without a trace.
  const TrialResult& result() const { return result_; }

  // The clock runs.
  bool timed() const { return stage_ >= Stage::kToB && stage_ != Stage::kEnded; }

 private:
  Vec3 aim() const;
  bool at_a(const Pose& X_ST) const;
  void marked(const LiveSample& now);
  void begin(Stage stage, const LiveSample& now);
  // The tools of this phase have been called.
  bool called(const LiveSample& now) const;
  void begin_with_tools(const LiveSample& now);
  void end(TrialEnd how, double time);

  LinearTask task_;
  StudyMode mode_;
  LinearMeasure measure_;
  Stage stage_ = Stage::kToA;
  bool seen_ = false;
  std::uint64_t marks_ = 0;
  LinearMeasure at_mark_;         // before the phase that runs
  std::vector<Pose> since_mark_;  // until its tools are called
  bool waits_for_tools_ = false;
  LiveSample now_;
  double off_ = 0.0;      // [m]
  double started_ = 0.0;  // [s]
  TrialResult result_;
};

}  // namespace handrail
