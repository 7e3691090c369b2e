#include "client/experiment/linear_live.h"

#include <spdlog/fmt/fmt.h>

#include "client/experiment/way_to_a.h"
#include "server/base/units.h"

namespace handrail {
namespace {

// "-45 deg about X", for a turn about an axis of the base.
std::string turn_text(const Vec3& turn) {
  int axis = 0;
  turn.cwiseAbs().maxCoeff(&axis);
  return fmt::format("{:.0f} deg about {}", turn[axis] / kDeg, "XYZ"[axis]);
}

}  // namespace

Vec3 LinearLive::aim() const {
  if (stage_ == Stage::kToC) return task_.p_SC;
  return stage_ < Stage::kToB ? task_.p_SA : task_.p_SB;
}

LinearPhase LinearLive::phase() const {
  if (stage_ == Stage::kTurn) return LinearPhase::kTurn;
  return stage_ == Stage::kToC ? LinearPhase::kToC : LinearPhase::kToB;
}

bool LinearLive::at_a(const Pose& X_ST) const {
  return (X_ST.p - task_.p_SA).norm() <= kNearA &&
         angle_between(X_ST.q, task_.q_first) <= kNearUpright;
}

void LinearLive::see(const LiveSample& now) {
  if (stage_ == Stage::kEnded) return;
  if (!seen_) marks_ = now.marks;  // those of before are no declaration
  seen_ = true;
  now_ = now;
  if (timed()) {
    if (!now.drives) return end(TrialEnd::kSession, now.time);
    measure_.add(now.X_ST);
    if (waits_for_tools_) {
      since_mark_.push_back(now.X_ST);
      if (called(now)) begin_with_tools(now);
    }
    if (now.time - started_ > kTrialLimit) return end(TrialEnd::kTimeOut, now.time);
  } else {
    const bool tool = now.position_tool || now.orientation_tool;
    const bool ready = now.drives && now.clutched && !tool && at_a(now.X_ST);
    stage_ = ready ? Stage::kAtA : Stage::kToA;
  }
  off_ = (now.X_ST.p - aim()).norm();
  // Fewer: the master has started anew, and these are none of this trial's.
  if (now.marks <= marks_) {
    marks_ = now.marks;
    return;
  }
  marks_ = now.marks;
  marked(now);
}

void LinearLive::marked(const LiveSample& now) {
  switch (stage_) {
    case Stage::kToA:
    case Stage::kEnded: return;
    case Stage::kAtA:
      started_ = now.marked;
      measure_.add(now.X_ST);
      return begin(Stage::kToB, now);
    case Stage::kToB:
    case Stage::kTurn:
      if (off_ > kOffTarget) return end(TrialEnd::kOffTarget, now.marked);
      return begin(stage_ == Stage::kToB ? Stage::kTurn : Stage::kToC, now);
    case Stage::kToC:
      return end(off_ > kOffTarget ? TrialEnd::kOffTarget : TrialEnd::kDone, now.marked);
  }
}

void LinearLive::begin(Stage stage, const LiveSample& now) {
  measure_.end();
  at_mark_ = measure_;
  since_mark_.clear();
  waits_for_tools_ = mode_ == StudyMode::kTools;
  stage_ = stage;
  measure_.begin(phase(), now.X_ST.q, now.q_command);
}

bool LinearLive::called(const LiveSample& now) const {
  return now.position_tool && now.orientation_tool == (stage_ != Stage::kTurn);
}

// What came before belongs to the path alone.
void LinearLive::begin_with_tools(const LiveSample& now) {
  waits_for_tools_ = false;
  measure_ = at_mark_;
  for (const Pose& X_ST : since_mark_) measure_.add(X_ST);
  measure_.begin(phase(), now.X_ST.q, now.q_command);
}

void LinearLive::end(TrialEnd how, double time) {
  stage_ = Stage::kEnded;
  fill_measured(measure_, result_);
  result_.end = how;
  result_.execution_time = time - started_;
}

std::string LinearLive::prompt() const {
  const bool tools = mode_ == StudyMode::kTools;
  switch (stage_) {
    case Stage::kToA:
      if (!now_.drives) return "Engage (E), and hold the hand: the arm goes to A by itself.";
      return now_.clutched ? "Hold the hand: the arm goes to A by itself."
                           : "The arm goes to A by itself.";
    case Stage::kAtA:
      if (now_.lets_go) return "At A. Let the hand go.";
      return fmt::format("At A. M starts the clock; then {}{} and go to B.",
                         tools ? "A-to-B (1), N-rotation (N), " : "", now_.frees);
    case Stage::kToB:
      if (tools) return fmt::format("A-to-B (1), N-rotation (N), {}: to B, then M.", now_.frees);
      return fmt::format("{}: straight to B without turning, then M.", now_.frees);
    case Stage::kTurn:
      return fmt::format("{}urn the tip by {}, staying at B, then M.",
                         tools ? "Drop the tools (X), at-B (2): t" : "T", turn_text(task_.turn));
    case Stage::kToC:
      return tools ? "B-to-C (3), N-rotation (N): to C, then M."
                   : "Straight to C without turning, then M.";
    case Stage::kEnded: break;
  }
  return {};
}

}  // namespace handrail
