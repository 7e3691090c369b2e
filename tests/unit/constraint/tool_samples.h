// Tool definitions and seeded vectors for tests of tools.
#pragma once

#include <random>

#include "server/model/tool.h"

namespace handrail::test {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3 within(double size) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }
  Vec3 unit() {
    Vec3 v;
    do v = within(1.0);
    while (v.norm() > 1.0 || v.norm() < 0.1);
    return v.normalized();
  }
  // Turned from the identity by up to `angle` about any axis.
  Quat turn(double angle) { return rotation_exp(between(0.0, angle) * unit()); }

 private:
  std::mt19937_64 random_;
};

inline ToolDefinition point_at(const Vec3& p) {
  ToolDefinition tool;
  tool.kind = ToolKind::kPoint;
  tool.id = 1;
  tool.p_SA = p;
  return tool;
}

inline ToolDefinition line_along(const Vec3& p, const Vec3& direction, bool one_way = false) {
  ToolDefinition tool = point_at(p);
  tool.kind = ToolKind::kLine;
  tool.direction_S = direction.normalized();
  tool.one_way = one_way;
  return tool;
}

inline ToolDefinition plane_across(const Vec3& p, const Vec3& normal) {
  ToolDefinition tool = point_at(p);
  tool.kind = ToolKind::kPlane;
  tool.normal_S = normal.normalized();
  return tool;
}

inline ToolDefinition ending_at(ToolDefinition tool, double end) {
  tool.has_end = true;
  tool.end = end;
  return tool;
}

}  // namespace handrail::test
