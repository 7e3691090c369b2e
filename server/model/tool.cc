#include "server/model/tool.h"

#include "server/base/fnv.h"

namespace handrail {

const char* name_of(ToolKind kind) noexcept {
  switch (kind) {
    case ToolKind::kPoint: return "point";
    case ToolKind::kLine: return "line";
    case ToolKind::kPlane: return "plane";
    case ToolKind::kNRotation: return "n-rotation";
    case ToolKind::kFRotation: return "f-rotation";
    case ToolKind::kNone: break;
  }
  return "none";
}

bool same_tool(const ToolDefinition& a, const ToolDefinition& b) noexcept {
  return a.kind == b.kind && a.p_SA == b.p_SA && a.direction_S == b.direction_S &&
         a.normal_S == b.normal_S && a.axis_T == b.axis_T && a.q_ref.coeffs() == b.q_ref.coeffs() &&
         a.one_way == b.one_way && a.has_end == b.has_end && a.end == b.end &&
         a.stiffness == b.stiffness;
}

std::uint64_t hash_of(const ToolDefinition& tool) noexcept {
  Fnv h;
  h.byte(static_cast<std::uint8_t>(tool.kind));
  for (const Vec3* v : {&tool.p_SA, &tool.direction_S, &tool.normal_S, &tool.axis_T}) {
    for (int i = 0; i < 3; ++i) h.f64((*v)[i]);
  }
  for (int i = 0; i < 4; ++i) h.f64(tool.q_ref.coeffs()[i]);
  h.byte(tool.one_way).byte(tool.has_end).f64(tool.end).f64(tool.stiffness);
  return h.value();
}

std::uint64_t tools_hash(const ToolDefinition& position,
                         const ToolDefinition& orientation) noexcept {
  if (position.epoch == 0 && orientation.epoch == 0) return 0;
  return Fnv().u64(hash_of(position)).u64(hash_of(orientation)).value();
}

}  // namespace handrail
