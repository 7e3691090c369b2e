#include "server/lab/faults/audit/place_audit.h"

#include <algorithm>

namespace handrail {

void PlaceAudit::remember(const Vec3& p, Nanos at) noexcept {
  const auto index = static_cast<std::size_t>((at / kBucket) % static_cast<Nanos>(kBuckets));
  Box& box = boxes_[index];
  const Nanos from = at / kBucket * kBucket;
  if (box.from != from) {
    box = {from, p, p};
    return;
  }
  box.low = box.low.cwiseMin(p);
  box.high = box.high.cwiseMax(p);
}

// A tip that only ever moves toward fresh commands comes nearer to the newest, but as far as that
// goes itself; or it stays among them and where it stood, where the arm can reach them. But for its
// stop where they turn before it. On a tool what it comes nearer to is the place asked for or that
// brought onto the tool, which may lie away from it.
bool PlaceAudit::commanded(const SentState& newest, const ToolAudit& tool, const JointAudit& joints,
                           const TipWay& motion, Nanos at) noexcept {
  const Pose& asked = newest.X_SU;
  const Vec3& tip = joints.tip();
  const bool was_beyond = beyond_reach_, new_tool = tool.calls() != tool_;
  beyond_reach_ = newest.has_command && !(in_reach(asked, joints.q()) &&
                                          in_reach({tool.on(asked.p), asked.q}, joints.q()));
  const bool just_beyond = beyond_reach_ && !was_beyond;
  const double went = went_to(asked);
  gap_.take((tip - asked.p).norm(), went, just_beyond);
  on_tool_.take((tip - tool.brought(asked.p, tip)).norm(), went, just_beyond || new_tool);
  tool_ = tool.calls();
  const double grown = std::min(gap_.grown(), on_tool_.grown());
  const double off = beyond_reach_ ? grown : std::min(grown, outside(tip, asked.p, at));
  // What now is asked may lie behind a tip on its way. One that has not yet come back from such a
  // stop keeps what that took.
  const double stop = motion.way_to_rest(joints);
  const bool turned = !was_beyond || new_tool || went > 0.0;
  if (off <= 0.0 && (turned || !beyond_reach_)) stop_ = stop;
  if (beyond_reach_ && turned) stop_ = std::max(stop_, stop);
  if (beyond_reach_) remember(tip, at);
  return off <= kRoom + stop_;
}

bool PlaceAudit::in_reach(const Pose& X, const JointVector& from) const noexcept {
  JointVector q;
  return is_finite(X) && inverse_near(limits_.arm, X, from, q) == InverseStatus::kOk &&
         (q.array() >= limits_.joints.lower.array()).all() &&
         (q.array() <= limits_.joints.upper.array()).all();
}

// How far what is asked went since the last command. Out of reach the place that the tip gets to
// goes along with the turn asked for.
double PlaceAudit::went_to(const Pose& asked) noexcept {
  double went = (asked.p - asked_.p).norm();
  if (beyond_reach_) went += limits_.arm.tip_radius() * angle_between(asked.q, asked_.q);
  asked_ = asked;
  return went;
}

// How far the tip is outside all places that it may be in.
double PlaceAudit::outside(const Vec3& tip, const Vec3& asked, Nanos at) const noexcept {
  Vec3 low = rest_.cwiseMin(asked);
  Vec3 high = rest_.cwiseMax(asked);
  for (const Box& box : boxes_) {
    if (at - box.from > static_cast<Nanos>(kBuckets) * kBucket) continue;
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  return std::max((low - tip).maxCoeff(), (tip - high).maxCoeff());
}

}  // namespace handrail
