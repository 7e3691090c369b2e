#include "server/lab/walls/wall_judge.h"

namespace handrail {

void WallJudge::see(const WallTick& tick, WallRunResult& result) {
  penetration_.see(tick);
  junctions_.see(tick);
  guidance_.see(tick);
  result.duration = tick.t;
  if (options_.traced) result.trace.push_back(tick);
}

void WallJudge::report(WallRunResult& result) const {
  result.inside_share = guidance_.inside_share();
  result.most_force = guidance_.most_force();
  result.deepest = penetration_.deepest();
  result.share_of_bound = penetration_.share_of_bound();
  result.junction_ratio = junctions_.ratio();
}

}  // namespace handrail
