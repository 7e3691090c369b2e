// A virtual tool as both sides know it: absolute, in the robot base frame S.
#pragma once

#include <cstdint>

#include "server/base/spatial.h"

namespace handrail {

enum class ToolKind : std::uint8_t { kNone, kPoint, kLine, kPlane, kNRotation, kFRotation };

inline bool is_position_tool(ToolKind kind) {
  return kind == ToolKind::kPoint || kind == ToolKind::kLine || kind == ToolKind::kPlane;
}
inline bool is_orientation_tool(ToolKind kind) {
  return kind == ToolKind::kNRotation || kind == ToolKind::kFRotation;
}

// "line", "n-rotation", "none", as people type it. Static storage.
const char* name_of(ToolKind kind) noexcept;

// The full definition of one active tool (dissertation 3.2.2). Fields a kind does not use keep
// their defaults, so that equal tools have equal hashes.
struct ToolDefinition {
  ToolKind kind = ToolKind::kNone;
  std::uint32_t id = 0;             // which call made it; 0 = no tool
  std::uint32_t epoch = 0;          // increases by one at every change of this slot, also to kNone
  Vec3 p_SA = Vec3::Zero();         // anchor: the point, the line's start, a point of the plane [m]
  Vec3 direction_S = Vec3::Zero();  // unit. Line: forward. Plane: forward in the plane, or zero.
  Vec3 normal_S = Vec3::Zero();     // unit. Plane: its normal. F-rotation: the axis r_ref kept.
  Vec3 axis_T = Vec3::Zero();  // unit. F-rotation: the axis in the tip's frame that stays on r_ref
  Quat q_ref = Quat::Identity();  // N-rotation: the orientation kept, q_ST
  bool one_way = false;           // forward along direction_S only
  bool has_end = false;
  double end = 0.0;        // furthest travel along direction_S from the anchor, > 0 [m]
  double stiffness = 0.0;  // K_t [N/m] at the hand; K_N, K_F [N m/rad] for orientation tools
};

// Whether both are the same definition (kind and geometry, not id or epoch). A NaN is never the
// same. Real-time safe.
bool same_tool(const ToolDefinition& a, const ToolDefinition& b) noexcept;

// Identity of the definition (kind and geometry, not id or epoch) for comparison across the link:
// FNV-1a over the fields' bytes, with -0.0 folded into 0.0. Not a cryptographic hash.
std::uint64_t hash_of(const ToolDefinition& tool) noexcept;

// Hash of a pair of tools, the same on both sides; 0 while neither slot has ever held one.
std::uint64_t tools_hash(const ToolDefinition& position,
                         const ToolDefinition& orientation) noexcept;

}  // namespace handrail
