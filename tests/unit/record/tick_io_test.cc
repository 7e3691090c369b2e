// What is kept of a tick or cycle comes back from its message to the bit.
#include "server/record/tick_io.h"

#include <gtest/gtest.h>

#include <limits>

#include "server/base/random.h"
#include "server/link/codec_fields.h"

namespace handrail {
namespace {

Vec3 any(Random& random) { return Vec3(random.normal(), random.normal(), random.normal()); }
Quat turn(Random& random) { return rotation_exp(any(random)); }
bool coin(Random& random) { return (random.bits() & 1u) != 0; }

// What a decoded datagram can be: the link's own form of it, twice through it the same.
template <typename State, typename Message>
State settled(State state) {
  Message message;
  put(state, message);
  State out;
  EXPECT_EQ(take(message, out), Reject::kNone);
  return out;
}

LinkView any_link(Random& random) {
  LinkView out;
  out.loop_age = static_cast<Nanos>(random.bits() >> 2);
  out.peer_age = kForever;
  out.received_of_100 = static_cast<int>(random.bits() % 101);
  out.peer_received_of_100 = static_cast<int>(random.bits() % 101);
  out.confirmed = coin(random);
  out.other_master = coin(random);
  return out;
}

HapticOrder any_order(Random& random) {
  HapticOrder out;
  out.kind = static_cast<OrderKind>(random.bits() % 12);
  out.drop_position = coin(random);
  out.drop_orientation = coin(random);
  out.stage = static_cast<int>(random.bits() % 7) - 1;
  out.screw_c = random.normal();
  out.grip = static_cast<Grip>(random.bits() % 3);
  out.why = static_cast<Reason>(random.bits() % static_cast<int>(Reason::kCount));
  ToolCall& call = out.tool;
  if (out.kind != OrderKind::kTool) return out;
  call.kind = static_cast<ToolKind>(random.bits() % 6);
  call.at_present = coin(random);
  for (Vec3* v :
       {&call.p_SA, &call.direction_S, &call.normal_S, &call.axis_S, &call.axis_T, &call.p_SE}) {
    *v = any(random);
  }
  call.q_ref = turn(random);
  call.has_axis = coin(random);
  call.has_axis_T = coin(random);
  call.has_q_ref = coin(random);
  call.one_way = coin(random);
  call.has_end = coin(random);
  call.stiffness = random.normal();
  call.approach = coin(random);
  return out;
}

SlaveState any_slave(Random& random) {
  SlaveState out;
  out.state = SessionState::kEngaged;
  out.X_ST_command = {any(random), turn(random)};
  out.X_ST = {any(random), turn(random)};
  for (int i = 0; i < kJoints; ++i) out.q_measured[i] = random.normal();
  out.f_E_S = {any(random), any(random)};
  out.surface = Surface{any(random).normalized(), 0.25 * random.normal(), 60e3};
  out.stop_epoch = random.bits();
  out.ledger.off_S.setConstant(static_cast<float>(random.normal()));
  return settled<SlaveState, pb::SlaveDatagram>(out);
}

void expect_same(const Vec3& a, const Vec3& b) { EXPECT_EQ(a, b); }
void expect_same(const Pose& a, const Pose& b) {
  EXPECT_EQ(a.p, b.p);
  EXPECT_EQ(a.q.coeffs(), b.q.coeffs());
}

// Field by field, by the message's own reading of the original and of what came back.
template <typename Kept, typename Message>
void expect_whole(const Kept& was, const Kept& is) {
  Message a, b;
  put(was, a);
  put(is, b);
  EXPECT_EQ(a.SerializeAsString(), b.SerializeAsString());
}

TEST(TickIo, ATickComesBackToTheBit) {
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    KeptTick was;
    was.number = random.bits();
    was.at = static_cast<Nanos>(random.bits() >> 2);
    was.scene = 3;
    was.given.dt = random.uniform() + 1e-9;
    was.given.let_go = coin(random);
    was.given.ends = coin(random);
    HapticInput& in = was.given.in;
    in.hand.X_MH = {any(random), turn(random)};
    in.hand.v_MH = any(random);
    in.hand.valid = coin(random);
    in.hand.clutch_button = coin(random);
    in.hand.drop_button = coin(random);
    in.hand.enable_button = coin(random);
    in.hand.force_missed = coin(random);
    in.order = any_order(random);
    in.slave_known = coin(random);
    if (in.slave_known) in.slave = any_slave(random);
    in.slave_age = coin(random) ? kForever : 12345;
    in.unseen = 77;
    in.hold_heard = coin(random) ? kForever : 3;
    in.device_ready = coin(random);
    in.link = any_link(random);
    pb::RecordedTick message;
    put(was, message);
    pb::RecordedTick parsed;
    ASSERT_TRUE(parsed.ParseFromString(message.SerializeAsString()));
    KeptTick is;
    ASSERT_TRUE(take(parsed, is));
    expect_whole<KeptTick, pb::RecordedTick>(was, is);
    expect_same(is.given.in.hand.X_MH, in.hand.X_MH);
    expect_same(is.given.in.hand.v_MH, in.hand.v_MH);
    EXPECT_EQ(is.given.in.hand.valid, in.hand.valid);
    EXPECT_EQ(is.given.in.hand.clutch_button, in.hand.clutch_button);
    EXPECT_EQ(is.given.in.hand.drop_button, in.hand.drop_button);
    EXPECT_EQ(is.given.in.hand.enable_button, in.hand.enable_button);
    EXPECT_EQ(is.given.in.hand.force_missed, in.hand.force_missed);
    EXPECT_EQ(is.given.dt, was.given.dt);
    EXPECT_EQ(is.given.let_go, was.given.let_go);
    EXPECT_EQ(is.given.in.slave_age, in.slave_age);
    EXPECT_EQ(is.given.in.hold_heard, in.hold_heard);
    EXPECT_EQ(is.given.in.link.peer_age, in.link.peer_age);
    EXPECT_EQ(is.given.in.link.other_master, in.link.other_master);
    EXPECT_EQ(is.given.in.order.kind, in.order.kind);
    if (in.order.kind != OrderKind::kNone) {
      EXPECT_EQ(is.given.in.order.stage, in.order.stage);
      EXPECT_EQ(is.given.in.order.why, in.order.why);
      expect_same(is.given.in.order.tool.p_SE, in.order.tool.p_SE);
      EXPECT_EQ(is.given.in.order.tool.q_ref.coeffs(), in.order.tool.q_ref.coeffs());
      EXPECT_EQ(is.given.in.order.tool.approach, in.order.tool.approach);
    }
  }
}

TEST(TickIo, ACycleComesBackToTheBit) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    KeptCycle was;
    was.number = random.bits();
    was.placed = coin(random);
    for (int i = 0; i < kJoints; ++i) {
      was.place[i] = was.placed ? random.normal() : 0.0;
      was.given.q_measured[i] = random.normal();
      was.given.q_commanded[i] = random.normal();
    }
    FollowInput& in = was.given;
    in.has_measured = coin(random);
    in.has_commanded = coin(random);
    in.answer = static_cast<Answer>(random.bits() % 3);
    in.anew = coin(random);
    in.cycles = 1 + static_cast<int>(random.bits() % 5);
    in.robot_ready = coin(random);
    in.master_known = coin(random);
    MasterState master;
    master.X_SU = {any(random), turn(random)};
    master.record = coin(random);
    if (in.master_known) in.master = settled<MasterState, pb::MasterDatagram>(master);
    in.master_age = kForever;
    in.master_sequence = random.bits();
    in.link = any_link(random);
    in.gripper = GripperState::kBetween;
    in.f_E_T = {any(random), any(random)};
    in.wrench_valid = coin(random);
    in.wrench_overrange = coin(random);
    in.fault = static_cast<Reason>(random.bits() % static_cast<int>(Reason::kCount));
    in.shutdown = coin(random);
    in.stop_input = coin(random);
    pb::RecordedCycle message;
    put(was, message);
    KeptCycle is;
    ASSERT_TRUE(take(message, is));
    expect_whole<KeptCycle, pb::RecordedCycle>(was, is);
    EXPECT_EQ(is.given.q_measured, in.q_measured);
    EXPECT_EQ(is.given.answer, in.answer);
    EXPECT_EQ(is.given.master.record, in.master.record);
    EXPECT_EQ(is.given.f_E_T.torque, in.f_E_T.torque);
    EXPECT_EQ(is.given.stop_input, in.stop_input);
    EXPECT_EQ(is.given.wrench_overrange, in.wrench_overrange);
    EXPECT_EQ(is.given.fault, in.fault);
    EXPECT_EQ(is.placed, was.placed);
    EXPECT_TRUE(!was.placed || is.place == was.place);
  }
}

// A program that begins anew does not know what its forerunner heard.
TEST(TickIo, WhereNothingIsKnownNothingIsLeftOfTheOtherSide) {
  KeptTick tick;
  tick.given.in.slave.stop_epoch = 3;
  pb::RecordedTick of_tick;
  put(KeptTick(), of_tick);
  of_tick.set_dt(1e-3);
  of_tick.set_slave_known(true);
  ASSERT_TRUE(take(of_tick, tick));
  EXPECT_EQ(tick.given.in.slave.stop_epoch, 3u) << "that of the tick before";
  of_tick.set_slave_known(false);
  ASSERT_TRUE(take(of_tick, tick));
  EXPECT_EQ(tick.given.in.slave.stop_epoch, SlaveState().stop_epoch);
  KeptCycle cycle;
  cycle.given.master.stop_epoch = 7;
  pb::RecordedCycle of_cycle;
  put(KeptCycle(), of_cycle);
  ASSERT_TRUE(take(of_cycle, cycle));
  EXPECT_EQ(cycle.given.master.stop_epoch, MasterState().stop_epoch);
}

TEST(TickIo, WhatIsMissingIsNamed) {
  pb::RecordedTick tick;
  put(KeptTick(), tick);
  KeptTick out;
  tick.set_dt(0.0);
  EXPECT_EQ(take(tick, out).message(), "dt is 0.000000 s, expected over 0, to 1");
  tick.set_dt(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(take(tick, out));
  tick.set_dt(1e-3);
  EXPECT_TRUE(take(tick, out));
  tick.mutable_slave()->set_reason(1);
  EXPECT_EQ(take(tick, out).message(), "slave is not whole");
  tick.clear_slave();
  tick.mutable_order()->set_kind(99);
  EXPECT_EQ(take(tick, out).message(), "order.kind is 99, which is none");
  tick.clear_order();
  tick.set_unseen_ns(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(take(tick, out).message(), "unseen_ns is 9223372036854775807 ns, which is no time");
  tick.set_unseen_ns(2 * kForever);
  EXPECT_TRUE(take(tick, out));
  tick.mutable_link()->set_peer_age_ns(-2 * kForever - 1);
  EXPECT_EQ(take(tick, out).message(),
            "link.peer_age_ns is -4611686018427387903 ns, which is no time");
  tick.mutable_link()->set_peer_age_ns(-2 * kForever);
  EXPECT_TRUE(take(tick, out));
  tick.mutable_hand()->RemoveLast();
  EXPECT_EQ(take(tick, out).message(), "hand has 9 numbers, expected 10");
  pb::RecordedCycle cycle;
  put(KeptCycle(), cycle);
  KeptCycle kept;
  EXPECT_TRUE(take(cycle, kept));
  cycle.set_answer(3);
  EXPECT_EQ(take(cycle, kept).message(), "answer is 3, which is none");
  cycle.set_answer(0);
  cycle.set_cycles(0);
  EXPECT_EQ(take(cycle, kept).message(), "cycles is 0, expected 1 to 100000");
  cycle.set_cycles(1);
  cycle.set_master_age_ns(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(take(cycle, kept).message(),
            "master_age_ns is -9223372036854775808 ns, which is no time");
  cycle.set_master_age_ns(0);
  cycle.mutable_q_measured()->Clear();
  EXPECT_EQ(take(cycle, kept).message(), "q_measured has 0 numbers, expected 6");
}

}  // namespace
}  // namespace handrail
