// States and bytes the link's tests share.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "server/base/version.h"
#include "server/link/codec.h"
#include "server/model/link_state.h"

namespace handrail {

inline ToolDefinition sample_plane() {
  ToolDefinition tool;
  tool.kind = ToolKind::kPlane;
  tool.id = 9;
  tool.epoch = 4;
  tool.p_SA = {0.5, -0.125, 0.25};
  tool.direction_S = {0, 1, 0};
  tool.normal_S = {0, 0, -1};
  tool.one_way = true;
  tool.has_end = true;
  tool.end = 0.0625;
  tool.stiffness = 800.0;
  return tool;
}

inline ToolDefinition sample_f_rotation() {
  ToolDefinition tool;
  tool.kind = ToolKind::kFRotation;
  tool.id = 8;
  tool.epoch = 2;
  tool.normal_S = {1, 0, 0};
  tool.axis_T = {0, 0, 1};
  tool.stiffness = 0.5;
  return tool;
}

inline SectionHashes sample_hashes() {
  return {0x1111111111111111, 0x2222222222222222, 0x3333333333333333, 0x4444444444444444};
}

inline MasterState sample_master() {
  MasterState s;
  s.desired = Desired::kEngaged;
  s.state = SessionState::kEngaged;
  s.X_SU = {{0.5, -0.25, 0.375}, Quat(0.5, -0.5, 0.5, 0.5)};
  s.has_command = true;
  s.stop_epoch = 0x8000000000000003;
  s.released_epoch = 0x8000000000000003;
  s.fault_reset = 0x9000000000000002;
  s.engagement_epoch = 0xa000000000000004;
  s.grip = Grip::kClosed;
  s.record = true;
  s.position_tool = sample_plane();
  s.orientation_tool = sample_f_rotation();
  s.hashes = sample_hashes();
  s.scene = scene_name("linear-movement");
  return s;
}

inline SlaveState sample_slave() {
  SlaveState s;
  s.state = SessionState::kHold;
  s.reason = Reason::kLinkHold;
  s.X_ST_command = {{0.5, -0.25, 0.375}, Quat::Identity()};
  s.X_ST = {{0.5, -0.25, 0.4375}, Quat(0, 0, 0, -1)};
  s.has_pose = true;
  s.q_measured << 0, -0.5, 1.5, 0.25, 1, -2;
  s.f_E_S = {{1, -2, 4}, {0.125, 0, -0.0}};
  s.has_wrench = true;
  s.payload_removed = true;
  s.log_lost = true;
  s.obstacle = Reason::kSensorMissing;
  s.stop_epoch = 0x8000000000000003;
  s.fault_epoch = 0x9000000000000002;
  s.engagement_epoch = 0xa000000000000004;
  s.position_tool_epoch = 4;
  s.orientation_tool_epoch = 2;
  s.oldest_applied = 19'500'000;
  s.cycles = 141;
  s.silences = 5;
  s.applied_sequence = 6;
  s.ledger.off_S << 0, 0, -0.25f, 0.0625f,  //
      0, 0, 0.125f, 0,                      //
      0, 0.5f, -0.0f, -2;
  s.ledger.why = {Reason::kNone, Reason::kBumper, Reason::kOutOfReach, Reason::kJointAcceleration};
  s.ledger.joint = 4;
  s.gripper = GripperState::kBetween;
  s.surface = {from_octahedral(octahedral({2.0, -3.0, -2.0})), -0.21875, 60e3};
  s.hashes = sample_hashes();
  s.scene = scene_name("linear-movement");
  s.program = {1'700'000'000'250'000'000, version_code("1.2.3"), {true, false, true}};
  return s;
}

inline DatagramHeader sample_header(std::uint64_t session = 1, std::uint64_t sequence = 1) {
  return {.session = session, .sequence = sequence, .sent = kSecond};
}

// A whole datagram; fails the calling test by being empty.
template <typename State>
std::vector<std::uint8_t> datagram(const DatagramHeader& header, const State& state) {
  Codec codec;
  std::vector<std::uint8_t> bytes(kMaxDatagram);
  Reject cause = Reject::kNone;
  bytes.resize(codec.encode(header, state, bytes, cause));
  return bytes;
}

// Equality bit for bit, member by member.
inline bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
template <typename A>
bool same(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<A>& b) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!same(a.derived()[i], b.derived()[i])) return false;
  }
  return true;
}
inline bool same(const Pose& a, const Pose& b) {
  return same(a.p, b.p) && same(a.q.coeffs(), b.q.coeffs());
}
inline bool same(const ToolDefinition& a, const ToolDefinition& b) {
  return a.kind == b.kind && a.id == b.id && a.epoch == b.epoch && same(a.p_SA, b.p_SA) &&
         same(a.direction_S, b.direction_S) && same(a.normal_S, b.normal_S) &&
         same(a.axis_T, b.axis_T) && same(a.q_ref.coeffs(), b.q_ref.coeffs()) &&
         a.one_way == b.one_way && a.has_end == b.has_end && same(a.end, b.end) &&
         same(a.stiffness, b.stiffness);
}
inline bool same(const SectionHashes& a, const SectionHashes& b) {
  return a.tools == b.tools && a.mapping == b.mapping && a.limits == b.limits && a.robot == b.robot;
}
inline bool same(const FollowLedger& a, const FollowLedger& b) {
  for (Eigen::Index i = 0; i < a.off_S.size(); ++i) {
    if (!same(a.off_S.data()[i], b.off_S.data()[i])) return false;
  }
  return a.why == b.why && a.joint == b.joint;
}
inline bool same(const MasterState& a, const MasterState& b) {
  return a.desired == b.desired && a.state == b.state && same(a.X_SU, b.X_SU) &&
         a.has_command == b.has_command && a.stop_epoch == b.stop_epoch &&
         a.released_epoch == b.released_epoch && a.fault_reset == b.fault_reset &&
         a.engagement_epoch == b.engagement_epoch && a.grip == b.grip && a.record == b.record &&
         same(a.position_tool, b.position_tool) && same(a.orientation_tool, b.orientation_tool) &&
         same(a.hashes, b.hashes) && a.scene == b.scene;
}
inline bool same(const SlaveState& a, const SlaveState& b) {
  return a.state == b.state && a.reason == b.reason && a.fault == b.fault &&
         same(a.X_ST_command, b.X_ST_command) && same(a.X_ST, b.X_ST) && a.has_pose == b.has_pose &&
         same(a.q_measured, b.q_measured) && same(a.f_E_S.force, b.f_E_S.force) &&
         same(a.f_E_S.torque, b.f_E_S.torque) && a.has_wrench == b.has_wrench &&
         a.payload_removed == b.payload_removed && a.log_lost == b.log_lost &&
         a.stop_epoch == b.stop_epoch && a.fault_epoch == b.fault_epoch &&
         a.engagement_epoch == b.engagement_epoch && a.obstacle == b.obstacle &&
         a.gripper == b.gripper && a.position_tool_epoch == b.position_tool_epoch &&
         a.orientation_tool_epoch == b.orientation_tool_epoch &&
         a.oldest_applied == b.oldest_applied && a.cycles == b.cycles && a.silences == b.silences &&
         a.applied_sequence == b.applied_sequence && same(a.ledger, b.ledger) &&
         a.surface == b.surface && same(a.hashes, b.hashes) && a.scene == b.scene &&
         a.program == b.program;
}

}  // namespace handrail
