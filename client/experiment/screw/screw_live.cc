#include "client/experiment/screw/screw_live.h"

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "server/base/plain_text.h"
#include "server/base/units.h"

namespace handrail {
namespace {

// So near to the start the arm has come: as to A of the linear movement.
constexpr double kNearStart = 1e-3;  // [m]
constexpr double kNearTurned = 1.0 * kDeg;
constexpr double kTurnMemory = 0.15;   // [s]
constexpr double kTurns = 5.0 * kDeg;  // [rad/s]

// The wrist has come to the middle of its way: more than what turning leaves, our choice.
constexpr double kAtMiddle = 2.0 * kDeg;

constexpr char kHead[] =
    "time_s,phase,tip_x_mm,tip_y_mm,tip_z_mm,tip_qw,tip_qx,tip_qy,tip_qz,turned_deg,depth_mm,"
    "slipped,jammed,force_x_n,force_y_n,force_z_n,spring_x_n,spring_y_n,spring_z_n\n";
constexpr const char* kPhases[] = {"align", "insert", "seek", "turn", "lift", "return"};

std::string three(const Vec3& v, double unit) {
  return fmt::format("{:.5f},{:.5f},{:.5f}", v.x() / unit, v.y() / unit, v.z() / unit);
}

}  // namespace

Pose RigSight::seen() const {
  const Vec3 bent = unbent - X_ST.p, axis = X_ST.q * Vec3::UnitZ();
  return {X_ST.p + bent - bent.dot(axis) * axis, X_ST.q};
}

void KeyTurning::add(double dt, const Quat& q_ST) noexcept {
  if (last_ && dt > 0.0) {
    const double by = -rotation_log(q_ST * last_->conjugate()).dot(out_);
    // A first-order mean, exact for any dt.
    speed_ += (1.0 - std::exp(-dt / kTurnMemory)) * (by / dt - speed_);
  }
  last_ = q_ST;
}

bool KeyTurning::turning() const noexcept { return speed_ > kTurns; }

ScrewLive::ScrewLive(const Scene& scene, ScrewMode mode, const Pose& X_start)
    : work_(scene),
      mode_(mode),
      X_start_(X_start),
      R_SM_(scene.mapping.R_SM),
      judge_(work_),
      turning_(work_.out) {}

bool ScrewLive::at_start(const Pose& X_ST) const {
  return (X_ST.p - X_start_.p).norm() <= kNearStart &&
         angle_between(X_ST.q, X_start_.q) <= kNearTurned;
}

void ScrewLive::see(const ScrewTold& now, std::span<const RigSight> moments,
                    std::optional<ScrewPhase> phase) {
  if (stage_ == Stage::kEnded) return;
  if (!seen_) marks_ = now.marks;  // those of before are no declaration
  seen_ = true;
  now_ = now;
  const bool marked = now.marks > marks_;
  marks_ = now.marks;
  if (!timed()) {
    waits_ = now.drives && now.clutched && !now.tool && at_start(now.X_ST);
    stage_ = waits_ && loose() && rig_ ? Stage::kReady : Stage::kToStart;
  }
  const bool starts = stage_ == Stage::kReady && marked;
  for (const RigSight& moment : moments) {
    if (timed() && moment.workpiece != workpiece_) return end(ScrewEnd::kSession);
    judge(moment, phase);
    if (stage_ == Stage::kEnded) return;
  }
  if (timed() && !now.drives) return end(ScrewEnd::kSession);
  if (starts) {
    stage_ = Stage::kTimed;
    started_ = rig_->time;
  }
  if (timed()) rows_.push_back({rig_->time - started_, phase_, *rig_, R_SM_ * now.spring_M});
}

void ScrewLive::judge(const RigSight& moment, std::optional<ScrewPhase> phase) {
  const double dt = rig_ ? moment.time - rig_->time : 0.0;
  turning_.add(dt, moment.X_ST.q);
  rig_ = moment;
  phase_ = phase.value_or(phase_of(moment));
  if (!timed()) return;
  const auto ended = judge_.add(dt, moment.time - started_,
                                {moment.X_ST.p, moment.force.norm(), moment.turned, moment.slipped,
                                 phase_ == ScrewPhase::kTurn});
  if (ended) end(*ended);
}

// Of who does not say it, as far as it can be told.
ScrewPhase ScrewLive::phase_of(const RigSight& moment) const {
  if (!(moment.depth > 0.0)) return ScrewPhase::kAlign;
  return turning_.turning() ? ScrewPhase::kTurn : ScrewPhase::kInsert;
}

void ScrewLive::lost() {
  if (timed()) end(ScrewEnd::kSession);
}

void ScrewLive::end(ScrewEnd how) {
  stage_ = Stage::kEnded;
  result_.end = how;
  result_.completion_time = rig_->time - started_;
  result_.measured = judge_.measured();
}

std::string ScrewLive::prompt() const {
  switch (stage_) {
    case Stage::kToStart:
      if (!now_.drives)
        return "Engage (E), and hold the hand: the arm goes to the start by itself.";
      if (waits_) return "The screw is being loosened.";
      return now_.clutched ? "Hold the hand: the arm goes to the start by itself."
                           : "The arm goes to the start by itself.";
    case Stage::kReady:
      if (now_.lets_go) return "At the start. Let the hand go.";
      return fmt::format("At the start. M starts the clock; then {}, and the key into the screw.",
                         now_.frees);
    case Stage::kTimed: return to_do();
    case Stage::kEnded: break;
  }
  return {};
}

std::string ScrewLive::to_do() const {
  const std::string so_far =
      fmt::format("Turned by {:.0f} of {:.0f} deg. ", rig_->turned / kDeg, work_.task.tight / kDeg);
  if (work_.is_tight(rig_->turned))
    return so_far + fmt::format("Tight: lift the key {:.0f} mm.", work_.task.clear / kMm);
  const bool tools = has_tools(mode_);
  const bool in = rig_->depth > work_.chamfer;
  if (!in && !tools) return so_far + "The key upright into the screw.";
  if (!in) return so_far + "Over the screw: axis (1), N-rotation (N); the key into it.";
  return so_far + (tools ? "F-rotation (F): turn" : "Turn") +
         " clockwise by half a turn; lift the key, turn it back.";
}

Quat next_turn(const Scene& scene, const Quat& start, const Quat& q_ST) {
  const Quat middle = screw_start(scene, 0.0).q;
  const Vec3 out = ScrewWork(scene).out;
  const auto beyond = [&](const Quat& q) { return rotation_log(q * middle.conjugate()).dot(out); };
  const bool same_side = beyond(q_ST) * beyond(start) >= 0.0;
  return same_side || std::abs(beyond(q_ST)) < kAtMiddle ? start : middle;
}

Status write_screw_trace(const std::string& file, const std::vector<ScrewRow>& rows) {
  if (rows.empty()) return Status::ok();
  std::ofstream out(file);
  out << kHead;
  for (const ScrewRow& row : rows) {
    const Quat& q = row.rig.X_ST.q;
    const std::string depth =
        std::isfinite(row.rig.depth) ? fmt::format("{:.5f}", row.rig.depth / kMm) : "";
    out << fmt::format("{:.4f},{},{},{:.7f},{:.7f},{:.7f},{:.7f},{:.4f},{},{},{},{},{}\n", row.time,
                       kPhases[static_cast<int>(row.phase)], three(row.rig.X_ST.p, kMm), q.w(),
                       q.x(), q.y(), q.z(), row.rig.turned / kDeg, depth, int{row.rig.slipped},
                       int{row.rig.jammed}, three(row.rig.force, 1.0), three(row.spring, 1.0));
  }
  out.close();
  if (out) return Status::ok();
  return Status::error(shown(file, 200) + ": cannot be written: " + std::strerror(errno));
}

}  // namespace handrail
