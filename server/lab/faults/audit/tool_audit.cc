#include "server/lab/faults/audit/tool_audit.h"

#include <algorithm>

#include "server/lab/faults/audit/stop_audit.h"

namespace handrail {

// A newer definition, or whatever the master comes back with. Another definition of the same epoch
// is none.
void ToolAudit::take(const SentState& entry) noexcept {
  const bool newer = entry.tool.epoch > tool_.epoch;
  if (!newer && !entry.aligning && entry.incarnation == of_) return;
  of_ = entry.incarnation;
  if (entry.tool.epoch == tool_.epoch && hash_of(entry.tool) == hash_of(tool_)) return;
  tool_ = entry.tool;
  space_ = space_of(tool_);
  new_ = true;
  ++calls_;
}

void ToolAudit::expect(const HeardMaster& master, const JointAudit& joints, const TipWay& motion,
                       Nanos at) noexcept {
  if (space_.everything()) return;
  const SentState& newest = master.newest();
  const double off = space_.distance(motion.tip());
  const double each = joints.way_of_joints();
  const double stop = std::max(motion.longest_way(motion.stop_time()), each);
  const double asked = newest.has_command ? space_.distance(newest.X_SU.p) : 0.0;
  if (new_) {
    reach_ = came_ = off + stop;
    been_ = off;
    due_ = at + from_seconds(motion.stop_time()) + StopAudit::kOverhead;
  }
  new_ = false;
  const double eased = reach_ - (master.led() ? eased_ : 0.0);
  been_ = std::max(been_, off);
  const double left = motion.longest_way(to_seconds(due_ - at + period_));
  const double leaving = at > due_ ? been_ : std::max(been_, off + std::max(left, each));
  reach_ = std::min({reach_, std::max({off + stop, asked, eased}), leaving});
}

Vec3 ToolAudit::brought(const Vec3& p, const Vec3& tip) const noexcept {
  const Vec3 off = space_.off(p);
  const double size = off.norm();
  if (size == 0.0) return p;
  const double part = std::clamp((tip - on(p)).dot(off) / size, 0.0, std::min(size, came_));
  return on(p) + part / size * off;
}

}  // namespace handrail
