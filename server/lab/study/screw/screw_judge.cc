#include "server/lab/study/screw/screw_judge.h"

namespace handrail {

const char* name_of(ScrewEnd end) noexcept {
  switch (end) {
    case ScrewEnd::kDone: return "done";
    case ScrewEnd::kForce: return "too hard";
    case ScrewEnd::kKeyLost: return "key lost";
    case ScrewEnd::kTimeOut: return "time-out";
    case ScrewEnd::kSession: return "session lost";
  }
  return "?";
}

ScrewWork::ScrewWork(const Scene& scene) : task(*scene.screw) {
  const HexSocketSpec& socket = *scene.simulate->find<HexSocketSpec>();
  p_SK = socket.X_SK.p;
  out = socket.X_SK.q * Vec3::UnitZ();
  depth = socket.depth;
  chamfer = socket.chamfer;
}

std::optional<ScrewEnd> ScrewJudge::add(double dt, double elapsed, const ScrewSight& now) noexcept {
  measure_.add(dt, now.p_ST, now.force);
  if (now.force > kTooHard) return ScrewEnd::kForce;
  // A key lifted out while it is still wound up slips too, which loses nothing.
  if (now.turning && now.slipped) return ScrewEnd::kKeyLost;
  if (work_.is_tight(now.turned) && work_.height(now.p_ST) >= work_.task.clear)
    return ScrewEnd::kDone;
  if (elapsed > kScrewLimit) return ScrewEnd::kTimeOut;
  return std::nullopt;
}

}  // namespace handrail
