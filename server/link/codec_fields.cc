#include "server/link/codec_fields.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

#include "server/link/check.h"

namespace handrail {
namespace {

using Doubles = google::protobuf::RepeatedField<double>;
using Floats = google::protobuf::RepeatedField<float>;
using Hashes = google::protobuf::RepeatedField<std::uint64_t>;
using Words = google::protobuf::RepeatedField<std::uint32_t>;

static_assert(static_cast<int>(SessionState::kCount) == pb::LinkSessionState_ARRAYSIZE);
static_assert(static_cast<int>(SessionState::kFault) == pb::SESSION_FAULT);
static_assert(static_cast<int>(SessionState::kHoming) == pb::SESSION_HOMING);
static_assert(static_cast<int>(Desired::kCount) == pb::LinkDesired_ARRAYSIZE);
static_assert(static_cast<int>(Grip::kCount) == pb::LinkGrip_ARRAYSIZE);
static_assert(static_cast<int>(GripperState::kCount) == pb::LinkGripper_ARRAYSIZE);
static_assert(static_cast<int>(GripperState::kBetween) == pb::GRIPPER_BETWEEN);
static_assert(static_cast<int>(ToolKind::kFRotation) == pb::TOOL_F_ROTATION);

// Appending in the order of link.proto, and taking back in the same order.
void add(Doubles* out, double v) { out->Add(v); }
template <typename Derived>
void add(Doubles* out, const Eigen::MatrixBase<Derived>& v) {
  for (Eigen::Index i = 0; i < v.size(); ++i) out->Add(v[i]);
}
void add(Doubles* out, const Quat& q) {
  for (const double v : {q.w(), q.x(), q.y(), q.z()}) out->Add(v);
}
void add(Doubles* out, const Pose& x) {
  add(out, x.p);
  add(out, x.q);
}

class Take {
 public:
  explicit Take(const Doubles& in) : in_(in) {}
  void operator()(double& v) { v = in_[next_++]; }
  template <typename Derived>
  void operator()(Eigen::MatrixBase<Derived>& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = in_[next_++];
  }
  // A quaternion already of unit length to rounding is left bit for bit.
  void operator()(Quat& q) {
    for (double* v : {&q.w(), &q.x(), &q.y(), &q.z()}) *v = in_[next_++];
    if (is_unit(q, kUnitTolerance) && !is_unit(q, 1e-12)) q.normalize();
  }
  void operator()(Pose& x) {
    (*this)(x.p);
    (*this)(x.q);
  }

 private:
  const Doubles& in_;
  int next_ = 0;
};

void put(Hashes* out, const SectionHashes& h) {
  for (const std::uint64_t v : {h.tools, h.mapping, h.limits, h.robot}) out->Add(v);
}
SectionHashes take_hashes(const Hashes& in) { return {in[0], in[1], in[2], in[3]}; }

std::size_t length_of(const SceneName& scene) {
  return static_cast<std::size_t>(std::find(scene.begin(), scene.end(), '\0') - scene.begin());
}
// False when the name leaves no room for the terminating zero.
bool take_scene(const std::string& in, SceneName& scene) {
  if (in.size() >= scene.size()) return false;
  scene.fill('\0');
  std::copy(in.begin(), in.end(), scene.begin());
  return true;
}

Reason reason_of(std::uint32_t code) {
  return static_cast<Reason>(std::min(code, static_cast<std::uint32_t>(Reason::kCount)));
}

// Stage by stage; a byte a reason, the first stage's lowest; joints from 1, 0 for none.
void put(const FollowLedger& ledger, pb::SlaveDatagram& m) {
  Floats* off = m.mutable_stage_offsets();
  for (Eigen::Index i = 0; i < ledger.off_S.size(); ++i) off->Add(ledger.off_S.data()[i]);
  std::uint32_t why = 0;
  for (std::size_t i = ledger.why.size(); i-- > 0;) {
    why = why << 8 | static_cast<std::uint32_t>(ledger.why[i]);
  }
  m.set_stage_reasons(why);
  m.set_limiting_joint(static_cast<std::uint32_t>(ledger.joint + 1));
}
void take(const pb::SlaveDatagram& m, FollowLedger& ledger) {
  for (Eigen::Index i = 0; i < ledger.off_S.size(); ++i) {
    ledger.off_S.data()[i] = m.stage_offsets(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < ledger.why.size(); ++i) {
    ledger.why[i] = reason_of(m.stage_reasons() >> 8 * i & 0xff);
  }
  ledger.joint = static_cast<std::int8_t>(
      static_cast<int>(std::min(m.limiting_joint(), static_cast<std::uint32_t>(kJoints + 1))) - 1);
}

// What is true of the program, a bit each: log lost 1, control thread 2, memory 4, IO thread 8.
std::uint32_t marks_of(const SlaveState& s) {
  const RealtimeGrants& granted = s.program.realtime;
  std::uint32_t marks = 0;
  for (const bool mark :
       {granted.io_fifo, granted.memory_locked, granted.control_fifo, s.log_lost}) {
    marks = marks << 1 | (mark ? 1u : 0u);
  }
  return marks;
}
bool take_marks(std::uint32_t marks, SlaveState& s) {
  s.log_lost = (marks & 1u) != 0;
  s.program.realtime = {(marks & 2u) != 0, (marks & 4u) != 0, (marks & 8u) != 0};
  return marks < 16;
}

// Normal, plane [um], stiffness [N/m]; 0 0 0 for none.
void put(Words* out, const std::optional<Surface>& surface) {
  const auto um = surface ? std::lround(surface->d * 1e6) : 0;
  out->Add(surface ? octahedral(surface->n_S) : 0);
  out->Add(static_cast<std::uint32_t>(static_cast<std::int32_t>(um)));
  out->Add(surface ? static_cast<std::uint32_t>(std::lround(surface->stiffness)) : 0);
}
// False for what has no stiffness and is somewhere.
bool take_surface(const Words& in, std::optional<Surface>& surface) {
  surface.reset();
  if (in[2] == 0) return in[0] == 0 && in[1] == 0;
  const auto um = static_cast<std::int32_t>(in[1]);
  surface = Surface{from_octahedral(in[0]), um / 1e6, static_cast<double>(in[2])};
  return true;
}

}  // namespace

void put(const MasterState& s, pb::MasterDatagram& m) {
  m.set_desired(static_cast<pb::LinkDesired>(s.desired));
  m.set_state(static_cast<pb::LinkSessionState>(s.state));
  add(m.mutable_command_pose(), s.X_SU);
  m.set_command_valid(s.has_command);
  m.set_stop_epoch(s.stop_epoch);
  m.set_released_epoch(s.released_epoch);
  m.set_fault_reset(s.fault_reset);
  m.set_grip(static_cast<pb::LinkGrip>(s.grip));
  m.set_engagement_epoch(s.engagement_epoch);
  m.set_record(s.record);
  const ToolDefinition& p = s.position_tool;
  m.set_position_kind(static_cast<pb::LinkToolKind>(p.kind));
  m.set_position_id(p.id);
  m.set_position_epoch(p.epoch);
  Doubles* geometry = m.mutable_position_geometry();
  for (const Vec3* v : {&p.p_SA, &p.direction_S, &p.normal_S}) add(geometry, *v);
  add(geometry, p.end);
  add(geometry, p.stiffness);
  m.set_position_one_way(p.one_way);
  m.set_position_has_end(p.has_end);
  const ToolDefinition& o = s.orientation_tool;
  m.set_orientation_kind(static_cast<pb::LinkToolKind>(o.kind));
  m.set_orientation_id(o.id);
  m.set_orientation_epoch(o.epoch);
  geometry = m.mutable_orientation_geometry();
  for (const Vec3* v : {&o.normal_S, &o.axis_T}) add(geometry, *v);
  add(geometry, o.q_ref);
  add(geometry, o.stiffness);
  put(m.mutable_hashes(), s.hashes);
  m.mutable_scene()->assign(s.scene.data(), length_of(s.scene));
  m.set_position_hash(hash_of(p));
  m.set_orientation_hash(hash_of(o));
}

bool present(const pb::MasterDatagram& m) {
  return m.has_desired() && m.has_state() && m.command_pose_size() == 7 && m.has_command_valid() &&
         m.has_stop_epoch() && m.has_released_epoch() && m.has_fault_reset() && m.has_grip() &&
         m.has_engagement_epoch() && m.has_record() && m.has_position_kind() &&
         m.has_position_id() && m.has_position_epoch() && m.position_geometry_size() == 11 &&
         m.has_position_one_way() && m.has_position_has_end() && m.has_orientation_kind() &&
         m.has_orientation_id() && m.has_orientation_epoch() &&
         m.orientation_geometry_size() == 11 && m.hashes_size() == 4 && m.has_scene() &&
         m.has_position_hash() && m.has_orientation_hash();
}

Reject take(const pb::MasterDatagram& m, MasterState& s) {
  s.desired = static_cast<Desired>(m.desired());
  s.state = static_cast<SessionState>(m.state());
  Take(m.command_pose())(s.X_SU);
  s.has_command = m.command_valid();
  s.stop_epoch = m.stop_epoch();
  s.released_epoch = m.released_epoch();
  s.fault_reset = m.fault_reset();
  s.grip = static_cast<Grip>(m.grip());
  s.engagement_epoch = m.engagement_epoch();
  s.record = m.record();
  ToolDefinition& p = s.position_tool = ToolDefinition{};
  p.kind = static_cast<ToolKind>(m.position_kind());
  p.id = m.position_id();
  p.epoch = m.position_epoch();
  Take position(m.position_geometry());
  for (Vec3* v : {&p.p_SA, &p.direction_S, &p.normal_S}) position(*v);
  for (double* v : {&p.end, &p.stiffness}) position(*v);
  p.one_way = m.position_one_way();
  p.has_end = m.position_has_end();
  ToolDefinition& o = s.orientation_tool = ToolDefinition{};
  o.kind = static_cast<ToolKind>(m.orientation_kind());
  o.id = m.orientation_id();
  o.epoch = m.orientation_epoch();
  Take orientation(m.orientation_geometry());
  for (Vec3* v : {&o.normal_S, &o.axis_T}) orientation(*v);
  orientation(o.q_ref);
  orientation(o.stiffness);
  s.hashes = take_hashes(m.hashes());
  return take_scene(m.scene(), s.scene) ? Reject::kNone : Reject::kScene;
}

bool tools_match(const pb::MasterDatagram& m, const MasterState& s) {
  return m.position_hash() == hash_of(s.position_tool) &&
         m.orientation_hash() == hash_of(s.orientation_tool);
}

void put(const SlaveState& s, pb::SlaveDatagram& m) {
  m.set_state(static_cast<pb::LinkSessionState>(s.state));
  m.set_reason(static_cast<std::uint32_t>(s.reason));
  m.set_fault(static_cast<std::uint32_t>(s.fault));
  add(m.mutable_command_pose(), s.X_ST_command);
  add(m.mutable_measured_pose(), s.X_ST);
  m.set_pose_valid(s.has_pose);
  add(m.mutable_joints(), s.q_measured);
  add(m.mutable_wrench(), s.f_E_S.force);
  add(m.mutable_wrench(), s.f_E_S.torque);
  m.set_wrench_valid(s.has_wrench);
  m.set_stop_epoch(s.stop_epoch);
  m.set_fault_epoch(s.fault_epoch);
  m.set_engagement_epoch(s.engagement_epoch);
  m.set_obstacle(static_cast<std::uint32_t>(s.obstacle));
  m.set_position_tool_epoch(s.position_tool_epoch);
  m.set_orientation_tool_epoch(s.orientation_tool_epoch);
  m.set_oldest_applied_ns(s.oldest_applied);
  m.set_cycles(s.cycles);
  m.set_silences(s.silences);
  m.set_applied_sequence(s.applied_sequence);
  m.set_payload_removed(s.payload_removed);
  m.set_calendar_ns(s.program.calendar);
  m.set_program(s.program.version);
  m.set_marks(marks_of(s));
  m.set_gripper(static_cast<pb::LinkGripper>(s.gripper));
  put(s.ledger, m);
  put(m.mutable_surface(), s.surface);
  put(m.mutable_hashes(), s.hashes);
  m.mutable_scene()->assign(s.scene.data(), length_of(s.scene));
}

bool present(const pb::SlaveDatagram& m) {
  return m.has_state() && m.has_reason() && m.has_fault() && m.command_pose_size() == 7 &&
         m.measured_pose_size() == 7 && m.has_pose_valid() && m.joints_size() == kJoints &&
         m.wrench_size() == 6 && m.has_wrench_valid() && m.has_stop_epoch() &&
         m.has_fault_epoch() && m.has_position_tool_epoch() && m.has_orientation_tool_epoch() &&
         m.has_oldest_applied_ns() && m.has_cycles() && m.has_silences() && m.hashes_size() == 4 &&
         m.has_scene() && m.has_applied_sequence() && m.has_payload_removed() &&
         m.stage_offsets_size() == 3 * FollowLedger::kStages && m.has_stage_reasons() &&
         m.has_limiting_joint() && m.has_engagement_epoch() && m.has_obstacle() && m.has_marks() &&
         m.has_calendar_ns() && m.has_program() && m.has_gripper() && m.surface_size() == 3;
}

Reject take(const pb::SlaveDatagram& m, SlaveState& s) {
  s.state = static_cast<SessionState>(m.state());
  s.reason = reason_of(m.reason());
  s.fault = reason_of(m.fault());
  Take(m.command_pose())(s.X_ST_command);
  Take(m.measured_pose())(s.X_ST);
  s.has_pose = m.pose_valid();
  Take(m.joints())(s.q_measured);
  Take wrench(m.wrench());
  wrench(s.f_E_S.force);
  wrench(s.f_E_S.torque);
  s.has_wrench = m.wrench_valid();
  s.stop_epoch = m.stop_epoch();
  s.fault_epoch = m.fault_epoch();
  s.engagement_epoch = m.engagement_epoch();
  s.obstacle = reason_of(m.obstacle());
  s.position_tool_epoch = m.position_tool_epoch();
  s.orientation_tool_epoch = m.orientation_tool_epoch();
  s.oldest_applied = m.oldest_applied_ns();
  s.cycles = m.cycles();
  s.silences = m.silences();
  s.applied_sequence = m.applied_sequence();
  s.payload_removed = m.payload_removed();
  s.program = {m.calendar_ns(), m.program(), {}};
  s.gripper = static_cast<GripperState>(m.gripper());
  take(m, s.ledger);
  s.hashes = take_hashes(m.hashes());
  if (!take_scene(m.scene(), s.scene)) return Reject::kScene;
  if (!take_marks(m.marks(), s)) return Reject::kRange;
  return take_surface(m.surface(), s.surface) ? Reject::kNone : Reject::kSurface;
}

}  // namespace handrail
