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
// stop where they turn before it.
bool PlaceAudit::commanded(const SentState& newest, const JointAudit& joints, const TipWay& motion,
                           Nanos at) noexcept {
  const Pose& asked = newest.X_SU;
  const double gap = (joints.tip() - asked.p).norm();
  const bool was_beyond = beyond_reach_;
  beyond_reach_ = newest.has_command && !in_reach(asked, joints.q());
  const double went = went_to(asked);
  gap_ = beyond_reach_ && !was_beyond ? gap : std::min(gap_ + went, gap);
  if (beyond_reach_) {
    // What now is asked may lie behind a tip on its way.
    if (!was_beyond || went > 0.0) remember_stop(joints, motion);
    const bool fine = !too_far(gap - gap_);
    remember(joints.tip(), at);
    return fine;
  }
  const double off = std::min(outside(joints.tip(), asked.p, at), gap - gap_);
  if (off <= 0.0) remember_stop(joints, motion);
  return !too_far(off);
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
  if (beyond_reach_) went += limits_.arm.d6 * angle_between(asked.q, asked_.q);
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

void PlaceAudit::remember_stop(const JointAudit& joints, const TipWay& motion) noexcept {
  last_asked_ = joints;
  even_way_ = motion.even_way();
}

// Further off than any stop since the tip was last where it was asked to be.
bool PlaceAudit::too_far(double off) const noexcept {
  return off > kRoom + even_way_ && off > kRoom + last_asked_.way_of_joints();
}

}  // namespace handrail
