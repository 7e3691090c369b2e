// How a trial of screw fastening is judged, moment by moment: in the study and at the running
// programs.
#pragma once

#include <cstdint>
#include <optional>

#include "server/model/scene.h"
#include "server/task/screw_measure.h"

namespace handrail {

// How a trial ended. Everything but kDone is a failure.
enum class ScrewEnd : std::uint8_t { kDone, kForce, kKeyLost, kTimeOut, kSession };
inline constexpr int kScrewEnds = 5;
const char* name_of(ScrewEnd end) noexcept;

inline constexpr double kScrewLimit = 120.0;  // a trial that takes longer has failed [s]
inline constexpr double kTooHard = 500.0;     // as has one that pushes harder [N]

// The screw of a scene with a screw task.
struct ScrewWork {
  Vec3 p_SK = Vec3::Zero();  // centre of the rim
  Vec3 out = Vec3::UnitZ();  // unit, out of the socket
  double depth = 0.0;        // of the bottom below the rim [m]
  double chamfer = 0.0;      // depth of the lead-in [m]
  ScrewTask task;

  explicit ScrewWork(const Scene& scene);
  double height(const Vec3& p_S) const { return (p_S - p_SK).dot(out); }  // above the rim [m]
  Vec3 above(double height) const { return p_SK + height * out; }
  bool is_tight(double turned) const { return turned >= task.tight; }
};

// What is at the screw at one moment of a trial.
struct ScrewSight {
  Vec3 p_ST = Vec3::Zero();  // true tip
  double force = 0.0;        // on it [N]
  double turned = 0.0;       // the screw [rad]
  bool slipped = false;      // the key has left the flats under load
  bool turning = false;      // the key is being turned to tighten: only then it is lost by that
};

// Pure.
class ScrewJudge {
 public:
  explicit ScrewJudge(const ScrewWork& work) : work_(work) {}

  // After `dt` more seconds of the trial. How it has ended, if it has.
  std::optional<ScrewEnd> add(double dt, double elapsed, const ScrewSight& now) noexcept;
  ScrewMeasured measured() const noexcept { return measure_.measured(); }

 private:
  ScrewWork work_;
  ScrewMeasure measure_;
};

}  // namespace handrail
