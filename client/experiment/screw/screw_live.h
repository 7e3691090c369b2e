// Screw fastening as somebody makes it at the running programs, moment by moment.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/lab/study/screw/screw_trial.h"

namespace handrail {

// What the master says at one moment. S but where another frame is named.
struct ScrewTold {
  Pose X_ST;                     // the tip, measured
  Vec3 contact = Vec3::Zero();   // measured [N]
  Pose X_MH;                     // the device, M
  Vec3 f_H_M = Vec3::Zero();     // on the hand, M [N]
  Vec3 spring_M = Vec3::Zero();  // of it the virtual spring's, M [N]
  bool drives = false;           // the hand leads the arm, or a clutch or the link holds it
  bool fault = false;
  bool clutched = false;
  bool tool = false;        // any is called
  const char* frees = "C";  // what lets the arm follow the hand after the clutch
  bool lets_go = false;     // the hand has to be let go before that
  std::uint64_t marks = 0;  // set so far
};

// What the rig says of one.
struct RigSight {
  std::uint64_t number = 0, workpiece = 0;
  double time = 0.0;  // the rig's clock [s]
  Pose X_ST;          // true
  Vec3 unbent = Vec3::Zero();
  Vec3 force = Vec3::Zero();
  double turned = 0.0, off_flats = 0.0;  // [rad]
  double depth = 0.0;                    // minus infinity: beside the mouth [m]
  bool slipped = false, jammed = false;

  // What is seen of a tool that touches: how far it has come by its end, and sideways by its body,
  // since a bent one looks crooked.
  Pose seen() const;
};

// Whether a key is being turned to tighten, of a person who does not say so: by its speed over the
// last 0.15 s, above 5 deg/s. Our choices: people turn at 50 deg/s and more, and come to rest
// before they lift.
class KeyTurning {
 public:
  // `out`: unit, out of the socket.
  explicit KeyTurning(const Vec3& out) : out_(out) {}
  void add(double dt, const Quat& q_ST) noexcept;
  bool turning() const noexcept;

 private:
  Vec3 out_;
  std::optional<Quat> last_;
  double speed_ = 0.0;  // clockwise [rad/s]
};

struct ScrewRow {
  double time = 0.0;  // since the clock started [s]
  ScrewPhase phase = ScrewPhase::kAlign;
  RigSight rig;
  Vec3 spring = Vec3::Zero();  // S [N]
};

// One trial, from wherever the tip is. With the arm at the start, the clutch closed and the screw
// loose a mark starts the clock. The study's code judges, on every moment of the rig; the trial
// ends by itself. Pure.
class ScrewLive {
 public:
  enum class Stage : std::uint8_t { kToStart, kReady, kTimed, kEnded };

  ScrewLive(const Scene& scene, ScrewMode mode, const Pose& X_start);

  // `moments`: the rig's since the last call. `phase`: of who says it.
  void see(const ScrewTold& now, std::span<const RigSight> moments,
           std::optional<ScrewPhase> phase = std::nullopt);
  // Master or rig do not answer.
  void lost();
  // The workpiece with that number is the trial's: no screw in it has been turned.
  void loosened(std::uint64_t workpiece) { workpiece_ = workpiece; }

  Stage stage() const { return stage_; }
  bool timed() const { return stage_ == Stage::kTimed; }
  bool loose() const { return workpiece_.has_value(); }
  // The arm waits at the start, and nobody has a tool: the screw can be loosened.
  bool waits() const { return waits_; }
  std::string prompt() const;
  // Once it has ended.
  const ScrewResult& result() const { return result_; }
  const std::vector<ScrewRow>& rows() const { return rows_; }

 private:
  bool at_start(const Pose& X_ST) const;
  void judge(const RigSight& moment, std::optional<ScrewPhase> phase);
  ScrewPhase phase_of(const RigSight& moment) const;
  void end(ScrewEnd how);
  std::string to_do() const;

  ScrewWork work_;
  ScrewMode mode_;
  Pose X_start_;
  Mat3 R_SM_;
  ScrewJudge judge_;
  KeyTurning turning_;
  Stage stage_ = Stage::kToStart;
  bool waits_ = false, seen_ = false;
  std::uint64_t marks_ = 0;
  std::optional<std::uint64_t> workpiece_;
  ScrewTold now_;
  std::optional<RigSight> rig_;
  ScrewPhase phase_ = ScrewPhase::kAlign;
  double started_ = 0.0;  // the rig's clock [s]
  ScrewResult result_;
  std::vector<ScrewRow> rows_;
};

// How the tip is to be turned next on its way to `start`, as it is at `q_ST`: at once, or first to
// the middle of the wrist's way. The wrist goes back as it came. Who has turned it further than the
// middle may be nearer to the start by the other way round, where a joint ends. Frame S.
Quat next_turn(const Scene& scene, const Quat& start, const Quat& q_ST);

// A head line with units, then a line a row. Nothing for no rows. The error names the file.
Status write_screw_trace(const std::string& file, const std::vector<ScrewRow>& rows);

}  // namespace handrail
