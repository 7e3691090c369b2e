#include "server/follow/tool_tube.h"

#include <algorithm>
#include <cmath>

#include "server/base/deletable.h"
#include "server/base/fnv.h"
#include "server/session/blend.h"

namespace handrail {
namespace {

// Rounding of a command that stands on its tool.
constexpr double kOnTool = 1e-9;  // [m], [rad]

// What is left of `size` after `dt`.
double let_go(double size, double rate, double dt) {
  Blend blend;
  blend.absorb({size, 0.0, 0.0});
  blend.decay(rate, dt);
  return blend.offset().x();
}

}  // namespace

void ToolTube::take_position(const ToolDefinition& tool, const Pose& X_ST,
                             const Pose& X_SU) noexcept {
  position_ = tool;
  radius_ = distance(X_ST.p);
  past_end_ = std::max(past_end(X_ST.p), past_end(X_SU.p));
  pace_ = std::max(way_to(X_ST.p), way_to(X_SU.p));
}

void ToolTube::take_orientation(const ToolDefinition& tool, const Pose& X_ST,
                                const Pose& X_SU) noexcept {
  orientation_ = OrientationTool(tool);
  orientation_.start(X_ST.q);
  angle_ = orientation_.deviation(X_ST.q);
  turn_pace_ = std::max(angle_, orientation_.deviation(X_SU.q));
}

void ToolTube::restart(const MasterState& master, const Pose& X_ST) noexcept {
  take_position(master.position_tool, X_ST, X_ST);
  take_orientation(master.orientation_tool, X_ST, X_ST);
  hash_ = tools_hash(position_, orientation_.definition());
}

Reason ToolTube::take(const MasterState& master, const Pose& X_ST) noexcept {
  const ToolDefinition& p = master.position_tool;
  const ToolDefinition& o = master.orientation_tool;
  const bool stale = p.epoch < position_epoch() || o.epoch < orientation_epoch() ||
                     (p.epoch == position_epoch() && !same_tool(p, position_)) ||
                     (o.epoch == orientation_epoch() && !same_tool(o, orientation_.definition()));
  if (stale) return Reason::kHashTools;
  if (p.epoch == position_epoch() && o.epoch == orientation_epoch()) return Reason::kNone;
  if (p.epoch != position_epoch()) take_position(p, X_ST, master.X_SU);
  if (o.epoch != orientation_epoch()) take_orientation(o, X_ST, master.X_SU);
  hash_ = tools_hash(position_, orientation_.definition());
  return Reason::kNone;
}

void ToolTube::close(double catch_up, double catch_up_rotation, const Vec3& p_SU, const Vec3& p_ST,
                     double dt) noexcept {
  pace_ = let_go(pace_, catch_up, dt);
  radius_ = std::min({radius_, pace_, std::max(distance(p_ST), distance(p_SU))});
  past_end_ = std::min({past_end_, pace_, std::max(past_end(p_ST), past_end(p_SU))});
  turn_pace_ = let_go(turn_pace_, catch_up_rotation, dt);
  angle_ = std::min(angle_, turn_pace_);
}

Vec3 ToolTube::across(const Vec3& p) const noexcept {
  Vec3 d = p - position_.p_SA;
  switch (position_.kind) {
    case ToolKind::kPoint: return d;
    case ToolKind::kLine: return d - d.dot(position_.direction_S) * position_.direction_S;
    case ToolKind::kPlane: return d.dot(position_.normal_S) * position_.normal_S;
    default: return Vec3::Zero();
  }
}

double ToolTube::past_end(const Vec3& p) const noexcept {
  const double travel = (p - position_.p_SA).dot(position_.direction_S);
  return position_.has_end ? std::max(travel - position_.end, 0.0) : 0.0;
}

double ToolTube::way_to(const Vec3& p) const noexcept {
  return std::hypot(distance(p), past_end(p));
}

TipSpace ToolTube::space(double room) const noexcept {
  if (!kept(Check::kToolTube)) return {};
  TipSpace space = space_of(position_);
  space.room = room;
  return space;
}

Vec3 ToolTube::bounded(const Vec3& p, double contact) const noexcept {
  if (!kept(Check::kToolTube)) return p;
  const Vec3 off = across(p);
  const double size = off.norm(), most = radius_ + contact;
  return size > most + kOnTool ? Vec3(p - off * (1.0 - most / size)) : p;
}

Pose ToolTube::project(const Pose& X_SU, const Pose& X_ST) noexcept {
  if (!kept(Check::kToolTube)) return X_SU;
  Pose X = X_SU;
  const Vec3& along = position_.direction_S;
  const double travel = (X.p - position_.p_SA).dot(along);
  const double tip = (X_ST.p - position_.p_SA).dot(along);
  double allowed = travel;
  if (position_.has_end) allowed = std::min(allowed, position_.end + past_end_);
  // Where limits made the tip turn late it is ahead of a command that has turned, and waits there.
  if (position_.one_way) allowed = std::max(allowed, tip);
  if (allowed != travel) X.p += (allowed - travel) * along;
  X.p = bounded(X.p, 0.0);
  // From where the tip is to the tool, not beyond it.
  const Vec3 side = across(X_ST.p);
  const double beyond = across(X.p).dot(side);
  if (beyond < 0.0) X.p -= beyond / side.squaredNorm() * side;

  if (!orientation_.active()) return X;
  const Quat q_tool = orientation_.advance(X.q);
  // Near half a turn off an axis the nearest orientation is held, and so may be far from `X`.
  if (orientation_.deviation(X.q) <= angle_ + kOnTool) return X;
  const Vec3 off = rotation_log(q_tool.conjugate() * X.q);
  const double angle = off.norm();
  if (angle > angle_ + kOnTool) {
    X.q = (q_tool * rotation_exp(off * (angle_ / angle))).normalized();
  }
  return X;
}

}  // namespace handrail
