#include "server/master/status_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/base/version.h"
#include "server/kinematics/rv2a.h"
#include "server/link/codec.h"
#include "server/master/set_vector.h"
#include "server/master/why_report.h"

namespace handrail {
namespace {

void set_pose(pb::PoseMm* out, const Pose& X) {
  set_vector(out->mutable_position_mm(), X.p, kMm);
  for (const double c : {X.q.w(), X.q.x(), X.q.y(), X.q.z()}) out->add_quaternion(c);
}

void set_share(pb::ForceShare* out, const Vec3& force) {
  out->set_magnitude_n(force.norm());
  set_vector(out->mutable_force_n(), force, 1.0);
}

void set_geometry(const ToolDefinition& tool, pb::ToolGeometry& out) {
  if (is_position_tool(tool.kind)) set_vector(out.mutable_anchor_mm(), tool.p_SA, kMm);
  const bool leads = !tool.direction_S.isZero();
  if (leads) set_vector(out.mutable_direction(), tool.direction_S, 1.0);
  if (leads && tool.one_way) out.set_one_way(true);
  if (tool.has_end) set_vector(out.mutable_end_mm(), tool.p_SA + tool.end * tool.direction_S, kMm);
  if (tool.kind == ToolKind::kPlane) set_vector(out.mutable_normal(), tool.normal_S, 1.0);
  if (tool.kind == ToolKind::kFRotation) {
    set_vector(out.mutable_axis(), tool.normal_S, 1.0);
    set_vector(out.mutable_axis_tip(), tool.axis_T, 1.0);
  }
  if (tool.kind == ToolKind::kNRotation) {
    const Quat& q = tool.q_ref;
    for (const double c : {q.w(), q.x(), q.y(), q.z()}) out.add_quaternion(c);
  }
}

void set_tool(pb::ToolStatus* out, const ToolDefinition& tool, const HapticOutput& step) {
  out->set_kind(name_of(tool.kind));
  out->set_id(tool.id);
  out->set_epoch(tool.epoch);
  out->set_hash(hash_of(tool));
  out->set_blending(step.blending);
  if (is_orientation_tool(tool.kind) && step.turning) out->set_turning(true);
  if (tool.kind != ToolKind::kNone) set_geometry(tool, *out->mutable_geometry());
  if (is_position_tool(tool.kind)) out->set_deviation_mm(step.deviation / kMm);
  if (is_orientation_tool(tool.kind)) out->set_deviation_deg(step.deviation_angle / kDeg);
}

double milliseconds(Nanos t) { return t < 0 || t >= kForever ? -1.0 : to_seconds(t) * 1e3; }

// The robot is where the slave says it is held; the master's own reason comes first where it has
// one.
std::string robot_reason(const HapticReport& report, const SlaveState& slave,
                         const LinkSnapshot& link, bool known, Nanos now) {
  if (link.refused(now)) return other_master_text(link, now);
  const HapticOutput& out = report.out;
  if (out.reason != Reason::kNone) return reason_text(out.reason, report);
  return describe(known ? slave.reason : Reason::kNoPeer);
}

void set_loop(const HapticReport& report, pb::Status& s) {
  s.set_ticks(report.ticks);
  s.set_overruns(report.overruns);
  pb::Lateness* late = s.mutable_loop_lateness_us();
  late->set_p50(static_cast<double>(report.late_p50) * 1e-3);
  late->set_p99(static_cast<double>(report.late_p99) * 1e-3);
  late->set_p999(static_cast<double>(report.late_p999) * 1e-3);
  late->set_max(static_cast<double>(report.late_max) * 1e-3);
}

// `known`: a slave has been heard, and takes part.
void set_link(const LinkSnapshot& link, bool known, Nanos now, pb::Status& s) {
  s.set_packet_age_ms(milliseconds(link.age(now)));
  s.set_loop_age_ms(milliseconds(link.loop_age(now)));
  s.set_link_quality(known ? name_of(link.quality(now)) : "none");
  s.set_peer_quality(known ? name_of(grade_of(link.peer_received_of_100)) : "none");
  s.set_loss_share(link.loss_share);
  s.set_round_trip_ms(milliseconds(link.round_trip));
  s.set_datagrams_accepted(link.accepted);
  s.set_datagrams_rejected(link.rejected);
}

void set_slave(const SlaveState& slave, bool known, pb::Status& s) {
  s.set_slave_state(known ? name_of(slave.state) : "none");
  s.set_slave_reason(known ? describe(slave.reason) : describe(Reason::kNoPeer));
  s.set_slave_scene(known ? std::string(text_of(slave.scene)) : "");
  s.set_slave_log_lost(known && slave.log_lost);
  s.set_oldest_applied_ms(milliseconds(slave.oldest_applied));
  s.set_slave_overruns(slave.silences);
  if (slave.gripper != GripperState::kNone) s.set_gripper(name_of(slave.gripper));
  if (known && slave.has_pose) {
    set_pose(s.mutable_slave_command(), slave.X_ST_command);
    set_pose(s.mutable_tip(), slave.X_ST);
  }
  s.set_has_contact_force(known && slave.has_wrench);
  if (known && slave.has_wrench) {
    set_vector(s.mutable_contact_force_n(), slave.f_E_S.force, 1.0);
    set_vector(s.mutable_contact_torque_n_m(), slave.f_E_S.torque, 1.0);
    s.set_payload_removed(slave.payload_removed);
  }
}

void set_plane(google::protobuf::RepeatedField<double>* out, const Vec2& v, double unit) {
  out->Add(v.x() / unit);
  out->Add(v.y() / unit);
}

}  // namespace

void show_walls(const WallReport& walls, pb::WallStatus& s) {
  s.set_stage(static_cast<std::uint32_t>(walls.stage));
  s.set_touching(walls.contact.touching);
  s.set_penetration_mm(walls.penetration / kMm);
  set_plane(s.mutable_proxy_mm(), walls.contact.proxy, kMm);
  set_plane(s.mutable_hand_mm(), walls.hand, kMm);
  set_plane(s.mutable_force_n(), walls.force, 1.0);
  s.set_region(walls.contact.region);
  s.set_locked(walls.locked);
  if (!walls.has_screw) return;
  s.set_turned_rad(walls.turned);
  s.set_screw_c(walls.screw_c);
}

std::string reason_text(Reason reason, const HapticReport& report) {
  std::string more;
  if (reason == Reason::kDeviceInvalid) more = text_of(report.trouble);
  const Reason fault = report.out.peer_fault;
  if (reason == Reason::kPeerFault && fault != Reason::kNone) more = describe(fault);
  return describe(reason) + (more.empty() ? "" : ": " + more);
}

std::string other_master_text(const LinkSnapshot& link, Nanos now) {
  return fmt::format("{} ({})", describe(Reason::kOtherMaster),
                     leader_text(link.refusal, now - link.refused_at));
}

std::string link_quality_text(const HapticOutput& out, const LinkSnapshot& link, Nanos now) {
  const double window = to_seconds(out.link_window);
  std::string found;
  const auto say = [&found](const std::string& text) {
    found += (found.empty() ? ": " : "; ") + text;
  };
  const auto judge = [&](double share, double most, const char* what) {
    if (out.link_window == 0 || !too_much(share, most)) return;
    say(fmt::format("{:.1f} % {}, at most {:.0f} % in {:g} s is asked", 100.0 * share, what,
                    100.0 * most, window));
  };
  const LinkShares& shares = out.link_shares;
  if (shares.heard < 1.0 && out.link_window > 0) {
    say(fmt::format("heard both ways for {:.2f} s without a gap of over 200 ms, {:g} s is asked",
                    window * shares.heard, window));
  }
  judge(shares.held, kMostHeld, "of the time nothing new here for over 20 ms");
  judge(shares.peer_held, kMostHeld, "of the time nothing new at the slave for over 20 ms");
  judge(shares.lost, kMostLost, "lost on the way here");
  judge(shares.peer_lost, kMostLost, "lost on the way to the slave");
  if (found.empty() && link.age(now) > kPoorAge && link.peer_epoch != 0) {
    say(fmt::format("nothing new here for {} ms, at most {} is asked", link.age(now) / kMillisecond,
                    kPoorAge / kMillisecond));
  }
  const int came = std::min(link.received_of_100, link.peer_received_of_100);
  if (found.empty() && grade_of(came) == LinkGrade::kPoor) {
    say(fmt::format("{} of 100 came, at least 40 are asked", came));
  }
  return describe(Reason::kLinkQuality) + found;
}

std::vector<std::string> hash_mismatches(const MasterState& master, const SlaveState& slave) {
  std::vector<std::string> out;
  const auto compare = [&out](const char* section, std::uint64_t a, std::uint64_t b) {
    if (a != b) out.push_back(fmt::format("{}: master {:016x}, slave {:016x}", section, a, b));
  };
  if (master.scene != slave.scene) {
    out.push_back(
        fmt::format("scene: master '{}', slave '{}'", text_of(master.scene), text_of(slave.scene)));
  }
  compare("mapping", master.hashes.mapping, slave.hashes.mapping);
  compare("limits", master.hashes.limits, slave.hashes.limits);
  compare("robot", master.hashes.robot, slave.hashes.robot);
  // Tools can be compared once the slave has the newest.
  if (master.position_tool.epoch == slave.position_tool_epoch &&
      master.orientation_tool.epoch == slave.orientation_tool_epoch) {
    compare("tools", master.hashes.tools, slave.hashes.tools);
  }
  return out;
}

namespace {

void set_peer(const LinkIdentity& link, const std::string& slave_at, pb::PeerStatus& out) {
  out.set_encrypted(link.encrypted);
  out.set_place(slave_at);
  if (!link.address.empty()) out.set_address(link.address);
  if (!link.name.empty()) {
    out.set_name(link.name);
    out.set_key(link.key_id);
    out.set_age_s(to_seconds(link.age));
  }
  if (link.problem.empty()) return;
  out.set_problem(link.problem);
  out.set_next(link.next);
}

void set_program(const ProgramNews& program, Nanos since, pb::ProgramStatus& out) {
  out.set_version(version_text(program.version));
  out.set_wire_version(kWireVersion);
  out.set_calendar_s(to_seconds(program.calendar + since));
  out.set_control_fifo(program.realtime.control_fifo);
  out.set_memory_locked(program.realtime.memory_locked);
  out.set_io_fifo(program.realtime.io_fifo);
}

// Of the slave as far as it is heard. Its calendar goes on since its newest datagram was sent.
void set_slave_program(const SlaveState& slave, const LinkSnapshot& link, bool known, Nanos now,
                       pb::Status& s) {
  if (const int other = link.other_version(now); other != 0) {
    s.mutable_slave_program()->set_wire_version(static_cast<std::uint32_t>(other));
  } else if (known && link.age(now) <= kConfirmedAge) {
    const Nanos way = std::max<Nanos>(link.round_trip, 0) / 2;
    set_program(slave.program, link.age(now) + way, *s.mutable_slave_program());
  }
}

void set_gate(const MasterIdentity& identity, const HapticOutput& out, pb::LinkGate& gate) {
  const LinkShares& shares = out.link_shares;
  gate.set_window_s(to_seconds(out.link_window));
  gate.set_heard_share(shares.heard);
  gate.set_held_share(shares.held);
  gate.set_peer_held_share(shares.peer_held);
  gate.set_most_held_share(kMostHeld);
  gate.set_lost_share(shares.lost);
  gate.set_peer_lost_share(shares.peer_lost);
  gate.set_most_lost_share(kMostLost);
  gate.set_loop_warn_ms(milliseconds(identity.loop_warn));
  gate.set_loop_limit_ms(milliseconds(identity.loop_limit));
}

// Where the hand wants the tip, before tools. Only while it leads.
void set_desired(const MotionLedger& motion, const SlaveState& slave, pb::Status& s) {
  if (!motion.known) return;
  set_pose(s.mutable_desired_tip(),
           {slave.X_ST_command.p - motion.off_S.rowwise().sum(), motion.q_SH});
}

void set_haptic(const MasterIdentity& identity, pb::DeviceStatus& out) {
  set_vector(out.mutable_workspace_half_mm(), identity.workspace_half, kMm);
  out.set_max_force_n(identity.max_force);
  out.set_has_rotation(identity.device_turns);
}

// Without a name in `identity` the sensor is one of a recording.
void set_handle(const MasterIdentity& identity, const HandleForce& handle, pb::Status& s) {
  if (handle.state == HandleState::kNone && identity.handle_sensor.empty()) return;
  pb::HandleStatus& out = *s.mutable_handle();
  if (!identity.handle_sensor.empty()) {
    out.set_sensor(identity.handle_sensor);
    out.set_simulated(identity.handle_simulated);
  }
  out.set_state(
      describe(handle.state == HandleState::kNone ? HandleState::kWaiting : handle.state));
  if (handle.felt_share) out.set_felt_share(*handle.felt_share);
  if (!handle.sound()) return;
  set_share(out.mutable_force(), handle.f_H_M.force);
  set_vector(out.mutable_torque_n_m(), handle.f_H_M.torque, 1.0);
  if (handle.has_stick) set_vector(out.mutable_stick_torque_n_m(), handle.stick_torque_M, 1.0);
}

void set_joints(google::protobuf::RepeatedField<double>* out, const JointVector& q) {
  for (const double angle : q) out->Add(angle / kDeg);
}

}  // namespace

void show_joints(const ArmGeometry& arm, const SlaveState& slave, pb::Status& status) {
  if (!status.has_tip()) return;
  set_joints(status.mutable_joints_deg(), slave.q_measured);
  JointVector q;
  if (inverse_near(arm, slave.X_ST_command, slave.q_measured, q) != InverseStatus::kOk) return;
  set_joints(status.mutable_joints_commanded_deg(), q);
}

namespace {

// Of a slave's fault the word alone, as `reason` says why.
std::string intervention_text(Reason reason, const HapticReport& report) {
  return reason == Reason::kPeerFault ? describe(reason) : reason_text(reason, report);
}

}  // namespace

pb::Status status_report(const MasterIdentity& identity, const HapticReport& report,
                         const SlaveState& slave, const LinkSnapshot& link, Nanos now) {
  pb::Status s;
  const HapticOutput& out = report.out;
  const bool known = link.peer_epoch != 0 && !report.walls.present;
  s.set_desired(name_of(out.link.desired));
  s.set_state(name_of(out.link.state));
  s.set_reason(robot_reason(report, slave, link, known, now));
  s.set_scene(std::string(text_of(out.link.scene)));
  s.set_device(identity.device);
  s.set_device_simulated(identity.device_simulated);
  s.set_realtime(identity.realtime);
  if (identity.link) set_peer(identity.link(now), identity.slave_at, *s.mutable_peer());
  set_program({calendar_now(), version_code(program_version()), identity.grants}, 0,
              *s.mutable_program());
  set_slave_program(slave, link, known, now, s);
  set_gate(identity, out, *s.mutable_gate());
  s.set_log_lost(identity.log_lost ? identity.log_lost() : 0);
  set_loop(report, s);
  set_link(link, known, now, s);
  set_slave(slave, known, s);
  set_ledger(s.mutable_ledger(), report, slave, link, now);
  set_tool(s.mutable_position_tool(), out.link.position_tool, out);
  set_tool(s.mutable_orientation_tool(), out.link.orientation_tool, out);
  set_share(s.mutable_tool_force(), out.shares.tool);
  set_share(s.mutable_spring_force(), out.shares.spring);
  set_share(s.mutable_limited_force(), out.shares.limited);
  set_share(s.mutable_device_force(), out.shares.device);
  set_handle(identity, report.handle, s);
  if (out.link.has_command) set_pose(s.mutable_command(), out.link.X_SU);
  set_pose(s.mutable_hand(), report.X_MH);
  set_desired(out.motion, slave, s);
  set_haptic(identity, *s.mutable_haptic());
  s.set_scene_epoch(report.scene_epoch);
  s.set_hand_moving(report.hand_moving);
  if (const auto trouble = text_of(report.trouble); !trouble.empty()) {
    s.set_device_trouble(std::string(trouble));
  }
  if (known) {
    for (const std::string& text : hash_mismatches(out.link, slave)) s.add_hash_mismatch(text);
  }
  if (report.walls.present) show_walls(report.walls, *s.mutable_walls());
  for (int i = 1; i < static_cast<int>(Reason::kCount); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (out.reasons.has(reason)) s.add_interventions(intervention_text(reason, report));
  }
  s.set_time_s(to_seconds(now));
  return s;
}

}  // namespace handrail
