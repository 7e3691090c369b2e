// A master's step with a hand that is moved by hand, and an arm that stands where it is told.
#pragma once

#include <memory>

#include "server/lab/sequences/tool_cases.h"

namespace handrail {

class CaseRig {
 public:
  // Engaged, without tools; an Omni with torque, tools called up to 60 mm away. The hand stands.
  CaseRig(const std::string& name, bool governor);

  // One tick of a millisecond with the hand at `X_MH`; the order is for this tick only.
  void tick(const Pose& X_MH);
  void stand(int ticks);
  // The hand goes on by `way` [m] and `turn` (rotation vector, frame M) within `ticks`, smoothly.
  void go(const Vec3& way, const Vec3& turn, int ticks);
  // Calls a tool with the hand at rest, or drops what there is of its slot; fails unless
  // `expected`.
  void call(const ToolCall& tool, Reason expected = Reason::kNone);
  void drop(bool position, bool orientation);
  // With the hand at rest: until all easing has ended, then ten seconds. Fills the row.
  void rest();

  const Pose& hand() const noexcept { return in_.hand.X_MH; }
  const Pose& command() const noexcept { return out_.link.X_SU; }
  Vec3 to_master(const Vec3& v_S) const { return settings_.mapping.R_SM.transpose() * v_S; }
  const HapticSettings& settings() const noexcept { return settings_; }
  // The row, with what bounds were broken.
  ToolCase finish();

 private:
  void order(const HapticOrder& order, Reason expected);
  void fail(const std::string& what);

  ToolCase row_;
  HapticSettings settings_;
  std::unique_ptr<HapticState> state_;
  HapticInput in_;
  HapticOutput out_;
  Watch watch_;
};

}  // namespace handrail
