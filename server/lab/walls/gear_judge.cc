#include "server/lab/walls/gear_judge.h"

namespace handrail {

void GearJudge::see(const WallTick& tick) {
  const double off = (tick.hand - gate_.neutral()).norm();
  if (!seen_ && off < gate_.home()) visited_.push_back("N");
  seen_ = true;
  rest_.see(tick);
  rested_ = !tick.effects.locked && off < gate_.home() && (rested_ || rest_.rests());
  const int locked = tick.effects.locked ? tick.effects.place : -1;
  if (locked >= 0 && locked != locked_)
    visited_.push_back(gate_.names()[static_cast<std::size_t>(locked)]);
  locked_ = locked;
}

std::vector<std::string> GearJudge::visited() const {
  std::vector<std::string> out = visited_;
  if (rested_ && out.size() > 1) out.push_back("N");
  return out;
}

}  // namespace handrail
