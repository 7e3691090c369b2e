#include "server/record/tick_io.h"

#include <initializer_list>
#include <string>
#include <utility>

#include "server/link/check.h"
#include "server/link/codec_fields.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

template <typename Derived>
void append(const Eigen::MatrixBase<Derived>& v, Numbers* out) {
  for (Eigen::Index i = 0; i < v.size(); ++i) out->Add(v.derived().data()[i]);
}
void append(const Quat& q, Numbers* out) {
  for (const double v : {q.w(), q.x(), q.y(), q.z()}) out->Add(v);
}
void append(const Wrench& w, Numbers* out) {
  append(w.force, out);
  append(w.torque, out);
}

// Takes numbers one after another; who calls has counted them.
class Next {
 public:
  explicit Next(const Numbers& in) : in_(in) {}
  double operator()() { return in_[at_++]; }
  template <typename Derived>
  void operator()(Eigen::PlainObjectBase<Derived>& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = in_[at_++];
  }
  void operator()(Quat& q) {
    for (double* v : {&q.w(), &q.x(), &q.y(), &q.z()}) *v = in_[at_++];
  }
  void operator()(Wrench& w) {
    (*this)(w.force);
    (*this)(w.torque);
  }

 private:
  const Numbers& in_;
  int at_ = 0;
};

Status missing(const std::string& field, const std::string& what) {
  return Status::error(field + " " + what);
}
Status wrong_count(const std::string& field, int has, int expected) {
  return missing(field,
                 "has " + std::to_string(has) + " numbers, expected " + std::to_string(expected));
}

template <typename Enum>
bool to_enum(std::uint32_t code, Enum last, Enum& out) {
  if (code > static_cast<std::uint32_t>(last)) return false;
  out = static_cast<Enum>(code);
  return true;
}
Status no_such(const char* field, std::uint32_t code) {
  return missing(field, "is " + std::to_string(code) + ", which is none");
}
template <typename Enum>
std::uint32_t code_of(Enum value) {
  return static_cast<std::uint32_t>(value);
}

constexpr Reason kLastReason = static_cast<Reason>(static_cast<int>(Reason::kCount) - 1);

// Of two times sum and difference are numbers, too.
constexpr Nanos kLongestTime = 2 * kForever;
using NamedTime = std::pair<const char*, Nanos>;
Status check_times(const pb::RecordedLink& link, std::initializer_list<NamedTime> more) {
  const auto of_link = {NamedTime("link.loop_age_ns", link.loop_age_ns()),
                        {"link.peer_age_ns", link.peer_age_ns()},
                        {"link.received_at_ns", link.received_at_ns()},
                        {"link.peer_sent_ns", link.peer_sent_ns()},
                        {"link.round_trip_ns", link.round_trip_ns()}};
  for (const auto& times : {more, of_link})
    for (const auto& [field, time] : times)
      if (time < -kLongestTime || time > kLongestTime)
        return missing(field, "is " + std::to_string(time) + " ns, which is no time");
  return Status::ok();
}

void put_link(const LinkView& link, const KeptTiming& timing, pb::RecordedLink& out) {
  out.set_loop_age_ns(link.loop_age);
  out.set_peer_age_ns(link.peer_age);
  out.set_received_of_100(link.received_of_100);
  out.set_peer_received_of_100(link.peer_received_of_100);
  out.set_confirmed(link.confirmed);
  out.set_other_master(link.other_master);
  if (timing.received_at == -kForever) return;
  out.set_received_at_ns(timing.received_at);
  out.set_peer_sent_ns(timing.peer_sent);
  out.set_round_trip_ns(timing.round_trip);
}
KeptTiming timing_of(const pb::RecordedLink& in) {
  if (!in.has_received_at_ns()) return {};
  return {in.received_at_ns(), in.peer_sent_ns(), in.round_trip_ns()};
}
LinkView link_of(const pb::RecordedLink& in) {
  return {in.loop_age_ns(),          in.peer_age_ns(), in.received_of_100(),
          in.peer_received_of_100(), in.confirmed(),   in.other_master()};
}

// Numbers of a tool call: six vectors, a quaternion, a stiffness.
constexpr int kToolNumbers = 6 * 3 + 4 + 1;
// Of a hand: place, quaternion, velocity. Of a sensor's reading: force, torque.
constexpr int kHandNumbers = 3 + 4 + 3, kSensorNumbers = 3 + 3;
// What no loop ever bridged or missed; the loops' own limits are far below. Keeps what a strange
// file claims from being worked through.
constexpr double kLongestTick = 1.0;  // [s]
constexpr int kMostCycles = 100'000;

void put_call(const ToolCall& call, pb::RecordedToolCall& out) {
  out.set_kind(static_cast<pb::LinkToolKind>(call.kind));
  out.set_at_present(call.at_present);
  Numbers* geometry = out.mutable_geometry();
  for (const Vec3& v :
       {call.p_SA, call.direction_S, call.normal_S, call.axis_S, call.axis_T, call.p_SE}) {
    append(v, geometry);
  }
  append(call.q_ref, geometry);
  geometry->Add(call.stiffness);
  out.set_has_axis(call.has_axis);
  out.set_has_axis_tip(call.has_axis_T);
  out.set_has_reference(call.has_q_ref);
  out.set_one_way(call.one_way);
  out.set_has_end(call.has_end);
  out.set_approach(call.approach);
}

Status take_call(const pb::RecordedToolCall& in, ToolCall& out) {
  if (in.geometry_size() != kToolNumbers) {
    return wrong_count("order.tool.geometry", in.geometry_size(), kToolNumbers);
  }
  out.kind = static_cast<ToolKind>(in.kind());
  out.at_present = in.at_present();
  Next next(in.geometry());
  for (Vec3* v :
       {&out.p_SA, &out.direction_S, &out.normal_S, &out.axis_S, &out.axis_T, &out.p_SE}) {
    next(*v);
  }
  next(out.q_ref);
  out.stiffness = next();
  out.has_axis = in.has_axis();
  out.has_axis_T = in.has_axis_tip();
  out.has_q_ref = in.has_reference();
  out.one_way = in.one_way();
  out.has_end = in.has_end();
  out.approach = in.approach();
  return Status::ok();
}

void put_order(const HapticOrder& order, pb::RecordedOrder& out) {
  out.set_kind(code_of(order.kind));
  if (order.kind == OrderKind::kTool) put_call(order.tool, *out.mutable_tool());
  out.set_drop_position(order.drop_position);
  out.set_drop_orientation(order.drop_orientation);
  out.set_stage(order.stage);
  out.set_screw_c(order.screw_c);
  out.set_grip(static_cast<pb::LinkGrip>(order.grip));
  out.set_why(code_of(order.why));
}

Status take_order(const pb::RecordedOrder& in, HapticOrder& out) {
  if (!to_enum(in.kind(), OrderKind::kGrip, out.kind)) return no_such("order.kind", in.kind());
  if (!to_enum(in.why(), kLastReason, out.why)) return no_such("order.why", in.why());
  if (out.kind == OrderKind::kTool) {
    if (Status taken = take_call(in.tool(), out.tool); !taken) return taken;
  }
  out.drop_position = in.drop_position();
  out.drop_orientation = in.drop_orientation();
  out.stage = in.stage();
  out.screw_c = in.screw_c();
  out.grip = static_cast<Grip>(in.grip());
  return Status::ok();
}

void put_given(const HapticTick& given, const KeptTiming& timing, pb::RecordedTick& out) {
  const HapticInput& in = given.in;
  out.set_dt(given.dt);
  out.set_let_go(given.let_go);
  out.set_ends(given.ends);
  append(in.hand.X_MH.p, out.mutable_hand());
  append(in.hand.X_MH.q, out.mutable_hand());
  append(in.hand.v_MH, out.mutable_hand());
  out.set_hand_marks(in.hand.valid * 1u | in.hand.clutch_button * 2u | in.hand.drop_button * 4u |
                     in.hand.enable_button * 8u | in.hand.force_missed * 16u);
  if (in.order.kind != OrderKind::kNone) put_order(in.order, *out.mutable_order());
  if (in.slave_known) put(in.slave, *out.mutable_slave());
  out.set_slave_known(in.slave_known);
  out.set_slave_age_ns(in.slave_age);
  out.set_unseen_ns(in.unseen);
  out.set_hold_heard_ns(in.hold_heard);
  out.set_device_ready(in.device_ready);
  put_link(in.link, timing, *out.mutable_link());
}

void put_came(const HapticOutput& o, pb::RecordedTick& out) {
  append(o.f_H_M, out.mutable_wrench());
  put(o.link, *out.mutable_command());
  out.set_order_result(code_of(o.order_result));
  out.set_reason(code_of(o.reason));
  out.set_obstacle(code_of(o.obstacle));
  out.set_peer_fault(code_of(o.peer_fault));
  for (std::uint32_t code = 1; code < code_of(Reason::kCount); ++code) {
    if (o.reasons.has(static_cast<Reason>(code))) out.add_reasons(code);
  }
  const ForceLedger& f = o.force;
  for (const Vec3* v :
       {&f.tool, &f.walls, &f.spring, &f.governor, &f.limits, &f.clamp, &f.cue, &f.device}) {
    append(*v, out.mutable_force());
  }
  append(o.motion.off_S, out.mutable_motion());
  for (const Reason why : o.motion.why) out.add_motion_why(code_of(why));
  out.set_joint(o.motion.joint);
  out.set_energy_made(o.energy_made);
  out.set_deviation(o.deviation);
  out.set_deviation_angle(o.deviation_angle);
  out.set_blending(o.blending);
  out.set_turning(o.turning);
  for (const double v : {o.tool_distance, o.tool_angle, o.hand_latched}) out.add_order_says(v);
  out.set_tool_id(o.tool_id);
}

void put_walls(const WallOutput& o, double turned, pb::RecordedWalls& out) {
  out.set_stage(o.stage);
  append(o.hand, out.mutable_hand());
  append(o.contact.proxy, out.mutable_proxy());
  append(o.contact.normal, out.mutable_normal());
  out.set_touching(o.contact.touching);
  out.set_region(o.contact.region);
  out.set_wall(o.contact.wall);
  out.set_work(o.contact.work);
  out.set_unfinished(o.contact.unfinished);
  out.set_locked(o.effects.locked);
  out.set_place(o.effects.place);
  append(o.effects.force, out.mutable_effects());
  out.set_turned(turned);
}

}  // namespace

void put(const KeptTick& tick, pb::RecordedTick& out) {
  out.Clear();
  out.set_number(tick.number);
  out.set_at_ns(tick.at);
  out.set_scene(tick.scene);
  put_given(tick.given, tick.timing, out);
  put_came(tick.came.out, out);
  if (tick.came.has_walls) put_walls(tick.came.walls, tick.turned, *out.mutable_walls());
  if (tick.handle.sound()) append(tick.handle.f_H_M, out.mutable_handle());
}

Status take(const pb::RecordedTick& in, KeptTick& out) {
  if (in.hand_size() != kHandNumbers) return wrong_count("hand", in.hand_size(), kHandNumbers);
  Status times = check_times(in.link(), {{"at_ns", in.at_ns()},
                                         {"slave_age_ns", in.slave_age_ns()},
                                         {"unseen_ns", in.unseen_ns()},
                                         {"hold_heard_ns", in.hold_heard_ns()}});
  if (!times) return times;
  out.number = in.number();
  out.at = in.at_ns();
  out.scene = in.scene();
  HapticTick& given = out.given;
  given.dt = in.dt();
  if (!(given.dt > 0.0 && given.dt <= kLongestTick)) {
    return missing("dt", "is " + std::to_string(given.dt) + " s, expected over 0, to 1");
  }
  given.let_go = in.let_go();
  given.ends = in.ends();
  HapticInput& to = given.in;
  Next next(in.hand());
  next(to.hand.X_MH.p);
  next(to.hand.X_MH.q);
  next(to.hand.v_MH);
  to.hand.valid = (in.hand_marks() & 1u) != 0;
  to.hand.clutch_button = (in.hand_marks() & 2u) != 0;
  to.hand.drop_button = (in.hand_marks() & 4u) != 0;
  to.hand.enable_button = (in.hand_marks() & 8u) != 0;
  to.hand.force_missed = (in.hand_marks() & 16u) != 0;
  to.order = HapticOrder();
  if (in.has_order()) {
    if (Status taken = take_order(in.order(), to.order); !taken) return taken;
  }
  if (in.has_slave()) {
    if (!present(in.slave())) return missing("slave", "is not whole");
    const bool sound = take(in.slave(), to.slave) == Reject::kNone;
    if (!sound || check(to.slave) != Reject::kNone) return missing("slave", "is no state");
  }
  to.slave_known = in.slave_known();
  if (!to.slave_known) to.slave = SlaveState();
  to.slave_age = in.slave_age_ns();
  to.unseen = in.unseen_ns();
  to.hold_heard = in.hold_heard_ns();
  to.device_ready = in.device_ready();
  to.link = link_of(in.link());
  out.timing = timing_of(in.link());
  return Status::ok();
}

void put(const KeptCycle& cycle, pb::RecordedCycle& out) {
  out.Clear();
  const FollowInput& in = cycle.given;
  out.set_number(cycle.number);
  out.set_at_ns(cycle.at);
  out.set_scene(cycle.scene);
  if (cycle.placed) append(cycle.place, out.mutable_placed());
  append(in.q_measured, out.mutable_q_measured());
  append(in.q_commanded, out.mutable_q_commanded());
  out.set_has_measured(in.has_measured);
  out.set_has_commanded(in.has_commanded);
  out.set_answer(code_of(in.answer));
  out.set_anew(in.anew);
  out.set_cycles(in.cycles);
  out.set_unseen_ns(in.unseen);
  out.set_robot_ready(in.robot_ready);
  if (in.master_known) put(in.master, *out.mutable_master());
  out.set_master_known(in.master_known);
  out.set_master_age_ns(in.master_age);
  out.set_master_sequence(in.master_sequence);
  put_link(in.link, cycle.timing, *out.mutable_link());
  out.set_gripper(static_cast<pb::LinkGripper>(in.gripper));
  append(in.f_E_T, out.mutable_sensor());
  out.set_sensor_valid(in.wrench_valid);
  if (in.wrench_overrange) out.set_sensor_overrange(true);  // older recordings have none
  out.set_fault(code_of(in.fault));
  out.set_ends(in.shutdown);
  out.set_stop_input(in.stop_input);
  append(cycle.came.q_target, out.mutable_q_target());
  out.set_send(code_of(cycle.came.send));
  out.set_grip(static_cast<pb::LinkGrip>(cycle.came.grip));
  put(cycle.came.link, *out.mutable_state());
}

Status take(const pb::RecordedCycle& in, KeptCycle& out) {
  const auto counted = [](const char* field, int has, int expected) {
    return has == expected ? Status::ok() : wrong_count(field, has, expected);
  };
  for (const Status& count : {counted("q_measured", in.q_measured_size(), kJoints),
                              counted("q_commanded", in.q_commanded_size(), kJoints),
                              counted("sensor", in.sensor_size(), kSensorNumbers)}) {
    if (!count) return count;
  }
  Status times = check_times(in.link(), {{"at_ns", in.at_ns()},
                                         {"master_age_ns", in.master_age_ns()},
                                         {"unseen_ns", in.unseen_ns()}});
  if (!times) return times;
  FollowInput& to = out.given;
  out.number = in.number();
  out.at = in.at_ns();
  out.scene = in.scene();
  out.placed = in.placed_size() != 0;
  if (out.placed && in.placed_size() != kJoints) {
    return wrong_count("placed", in.placed_size(), kJoints);
  }
  if (out.placed) Next(in.placed())(out.place);
  Next(in.q_measured())(to.q_measured);
  Next(in.q_commanded())(to.q_commanded);
  to.has_measured = in.has_measured();
  to.has_commanded = in.has_commanded();
  if (!to_enum(in.answer(), Answer::kNone, to.answer)) return no_such("answer", in.answer());
  to.anew = in.anew();
  to.cycles = in.cycles();
  if (to.cycles < 1 || to.cycles > kMostCycles) {
    return missing("cycles", "is " + std::to_string(to.cycles) + ", expected 1 to " +
                                 std::to_string(kMostCycles));
  }
  to.unseen = in.unseen_ns();
  to.robot_ready = in.robot_ready();
  if (in.has_master()) {
    if (!present(in.master())) return missing("master", "is not whole");
    const bool sound = take(in.master(), to.master) == Reject::kNone;
    if (!sound || check(to.master) != Reject::kNone) return missing("master", "is no state");
  }
  to.master_known = in.master_known();
  if (!to.master_known) to.master = MasterState();
  to.master_age = in.master_age_ns();
  to.master_sequence = in.master_sequence();
  to.link = link_of(in.link());
  out.timing = timing_of(in.link());
  to.gripper = static_cast<GripperState>(in.gripper());
  Next(in.sensor())(to.f_E_T);
  to.wrench_valid = in.sensor_valid();
  to.wrench_overrange = in.sensor_overrange();
  if (!to_enum(in.fault(), kLastReason, to.fault)) return no_such("fault", in.fault());
  to.shutdown = in.ends();
  to.stop_input = in.stop_input();
  return Status::ok();
}

}  // namespace handrail
