#include "server/constraint/position_tool.h"

#include <algorithm>

namespace handrail {
namespace {

// The published loop is unbounded. This many steps reach a hand 50 mm away at the default step; a
// proxy that needs more carries on next tick.
constexpr int kMaxStepsPerTick = 256;

Vec3 any_perpendicular(const Vec3& n) {
  // Against the smallest component, so that the product is far from zero.
  Eigen::Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vec3::Unit(smallest)).normalized();
}

}  // namespace

PositionTool::PositionTool(const ToolDefinition& tool, GuidanceMethod method, double delta) noexcept
    : tool_(tool), method_(method), delta_(delta) {
  if (tool.kind == ToolKind::kLine) {
    dimensions_ = 1;
    axis_[0] = tool.direction_S;
  } else if (tool.kind == ToolKind::kPlane) {
    dimensions_ = 2;
    axis_[0] = tool.direction_S.isZero() ? any_perpendicular(tool.normal_S) : tool.direction_S;
    axis_[1] = tool.normal_S.cross(axis_[0]);
  }
}

double PositionTool::forward_limit(double wanted) const noexcept {
  return tool_.has_end ? std::min(wanted, tool_.end) : wanted;
}

Vec3 PositionTool::proxy() const noexcept {
  Vec3 p = tool_.p_SA;
  for (int i = 0; i < dimensions_; ++i) {
    p += t_[static_cast<std::size_t>(i)] * axis_[static_cast<std::size_t>(i)];
  }
  return p;
}

Vec3 PositionTool::start(const Vec3& p_SP, const Vec3& p_SC) noexcept {
  if (!active()) return p_SP;
  for (std::size_t i = 0; i < 2; ++i) t_[i] = (p_SP - tool_.p_SA).dot(axis_[i]);
  if (tool_.one_way) t_[0] = std::max(t_[0], (p_SC - tool_.p_SA).dot(axis_[0]));
  t_[0] = forward_limit(t_[0]);
  return proxy();
}

Vec3 PositionTool::advance(const Vec3& p_SH) noexcept {
  if (!active()) return p_SH;
  if (method_ == GuidanceMethod::kPublished) {
    advance_by_steps(p_SH);
  } else {
    const Vec3 d = p_SH - tool_.p_SA;
    const double wanted = forward_limit(d.dot(axis_[0]));
    t_[0] = tool_.one_way ? std::max(t_[0], wanted) : wanted;
    t_[1] = d.dot(axis_[1]);
  }
  return proxy();
}

void PositionTool::advance_by_steps(const Vec3& p_SH) noexcept {
  int steps = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(dimensions_); ++i) {
    // Along one axis the distance shrinks as long as the projection is over half a step away.
    const double hand = (p_SH - tool_.p_SA).dot(axis_[i]);
    for (const double direction : {+1.0, -1.0}) {
      if (direction < 0.0 && i == 0 && tool_.one_way) continue;
      while (steps < kMaxStepsPerTick) {
        const double next = t_[i] + direction * delta_;
        if (direction > 0.0 && i == 0 && tool_.has_end && !(next < tool_.end)) break;
        if (!(std::abs(hand - next) < std::abs(hand - t_[i]))) break;
        t_[i] = next;
        ++steps;
      }
    }
  }
}

Vec3 PositionTool::along(const Vec3& v) const noexcept {
  if (!active()) return v;
  Vec3 out = Vec3::Zero();
  for (int i = 0; i < dimensions_; ++i) {
    const Vec3& axis = axis_[static_cast<std::size_t>(i)];
    out += v.dot(axis) * axis;
  }
  return out;
}

double PositionTool::distance(const Vec3& p) const noexcept {
  if (!active()) return 0.0;
  Vec3 d = p - tool_.p_SA;
  for (int i = 0; i < dimensions_; ++i) {
    const Vec3& axis = axis_[static_cast<std::size_t>(i)];
    d -= d.dot(axis) * axis;
  }
  return d.norm();
}

double PositionTool::travel(const Vec3& p) const noexcept { return (p - tool_.p_SA).dot(axis_[0]); }

}  // namespace handrail
