#include "server/lab/faults/audit/tool_audit.h"

#include <algorithm>

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
}

void ToolAudit::expect(const HeardMaster& master, const JointAudit& joints,
                       const TipWay& motion) noexcept {
  if (space_.everything()) return;
  const SentState& newest = master.newest();
  const double reach = space_.distance(motion.tip()) + motion.way_to_rest(joints);
  const double asked = newest.has_command ? space_.distance(newest.X_SU.p) : 0.0;
  const double eased = reach_ - (master.led() ? eased_ : 0.0);
  reach_ = new_ ? reach : std::min(reach_, std::max({reach, asked, eased}));
  new_ = false;
}

}  // namespace handrail
