#include "server/motion/stop_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/kinematics/jacobian.h"

namespace handrail {
namespace {

// What is sent may take half of what a plan spares of the guard's limits: curves are foreseen but
// for their third order, and a law at its limit is rounded. The rest is for 32 bits on the wire.
constexpr double kSent = 0.5 * (1.0 + kMotion.plan_share) / kMotion.plan_share;

// What a stop may take beside v/a, in cycles.
double bend_time(const AxisLimits& limits) {
  return kMotion.stop_jerks * std::max(limits.acceleration / limits.jerk, kTiny.landing);
}

// Time to stop that is allowed, in cycles.
double stop_bound(const PlanLimits& limits, const JointVector& step) {
  double cycles = 0.0;
  for (int i = 0; i < kJoints; ++i) {
    const AxisLimits& l = limits.guard.axis[static_cast<std::size_t>(i)];
    cycles = std::max(cycles, std::abs(step[i]) / l.acceleration + bend_time(l));
  }
  return cycles;
}

// The largest part of `room` that a motion in which the joints turn at `rate` may take.
double part_of(const JointVector& room, const JointVector& rate) {
  // A joint that neither turns nor has room bounds nothing: 0 / 0 becomes kUnbounded.
  const JointVector part = (room.array() + kTiny.nothing * kUnbounded)
                               .cwiseQuotient(rate.array().abs() + kTiny.nothing)
                               .matrix();
  return std::min(part.minCoeff(), kUnbounded);
}

// One stop, a cycle at a time.
class RollOut {
 public:
  RollOut(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
          const TipPlace& tip)
      : limits_(limits),
        space_(space),
        joints_(from.joints),
        from_(from.joints.q),
        p_(from.X_ST.p),
        tip_(tip),
        inverse_(limits) {
    way_ = joints_.step;
    p_way_ = space.along(from.tip_step.linear);
    way_S_ = p_way_.norm() > kTiny.off ? Vec3(p_way_.normalized()) : Vec3(Vec3::Zero());
    JointVector q = joints_.q + way_;
    TipPlace on = tip_;
    on.turn(way_);
    if (inverse_.bring_to(space.nearest(p_ + p_way_), on, q)) curve_ = q - joints_.q - way_;
    const JointVector bend = joints_.change - curve_;
    const JointVector w = limits.acceleration.cwiseInverse();
    const JointVector scaled = w.cwiseProduct(way_);
    const double size = scaled.squaredNorm();
    if (size > 0.0) along_ = {0.0, 1.0, scaled.dot(w.cwiseProduct(bend)) / size};
    bend_ = bend - along_.a * way_;
    p_bend_ = space.along(from.tip_change.linear) - along_.a * p_way_;
    // The bend gets its part of the jerk, beside what braking that has begun needs to end at rest.
    // Next to none ends at once.
    const double bent = w.cwiseProduct(bend_).cwiseAbs().maxCoeff();
    const double gone = scaled.cwiseAbs().maxCoeff();
    const double taken = std::max(bent, bent / (bent + gone + kTiny.joint));
    if (bend_.cwiseAbs().cwiseQuotient(limits.jerk).maxCoeff() > kSent - 1.0) {
      across_ = {0.0, 0.0, 1.0};
      const double braking = std::max(-along_.a, 0.0);
      const double needed = braking * braking / (2.0 + braking);
      const JointVector left = (limits.jerk - needed * way_.cwiseAbs()).cwiseMax(0.0);
      across_jerk_ = std::max(std::min(taken * part_of(limits.jerk, bend_), part_of(left, bend_)),
                              kTiny.share);
    } else {
      bend_.setZero();
      p_bend_.setZero();
    }
  }

  bool run(Stopping how, StopPlan& plan, Verdict& why) {
    const double bound = stop_bound(limits_, joints_.step);
    plan.size = plan.next = 0;
    while (plan.size < StopPlan::kCapacity && plan.size <= bound) {
      JointVector step = how == Stopping::kAsOne ? as_one() : each();
      if (step.cwiseAbs().maxCoeff() < kTiny.joint) step.setZero();
      JointVector q = joints_.q + step;
      if (!space_.everything() && !step.isZero(0.0)) {
        tip_.turn(step);
        if (!keep_way(how, q, why)) return false;
      }
      if (how == Stopping::kAsOne && along_.v > 0.0) way_ += curve_ / along_.v;
      why = plan_allows(limits_, joints_, q);
      if (why.reason != Reason::kNone) return false;
      advance(limits_, joints_, q);
      plan.q[static_cast<std::size_t>(plan.size++)] = q;
      if (joints_.step.isZero(0.0) && joints_.change.isZero(0.0)) {
        plan.p_end = space_.everything() ? end_of(q) : p_;
        return true;
      }
    }
    why = {Reason::kJointAcceleration, -1};
    return false;
  }

 private:
  // The tip at `q`, at the end of a stop in which it was not turned along.
  Vec3 end_of(const JointVector& q) {
    const JointVector by = q - from_;
    // J2 and J3 are turned as one.
    if (by.cwiseAbs().maxCoeff() >= 0.5 * TipPlace::kMostTurn)
      return TipPlace(limits_.guard.arm, q).p();
    tip_.turn(by);
    return tip_.p();
  }

  // The next step of joints that slow together, by what their bend leaves them.
  JointVector as_one() {
    if (across_jerk_ > 0.0) {
      across_.a = stop_change({kUnbounded, 1.0, across_jerk_}, across_.v, across_.a);
      across_.v += across_.a;
      if (std::abs(across_.v) < kTiny.share && std::abs(across_.a) < kTiny.share)
        across_jerk_ = 0.0;
    }
    if (across_jerk_ == 0.0) across_.v = across_.a = 0.0;
    const JointVector bend = bend_.cwiseAbs();
    const JointVector room = limits_.acceleration - std::abs(across_.a) * bend - curve_.cwiseAbs();
    // The curve goes with the square of the speed.
    const double turned = along_.v > 0.0 ? std::min(1.0, 2.0 * std::abs(along_.a) / along_.v) : 0.0;
    const JointVector jerk_room = limits_.jerk - across_jerk_ * bend - turned * curve_.cwiseAbs();
    const double jerk =
        std::max(kMotion.plan_share * part_of(jerk_room.cwiseMax(0.0), way_), kTiny.share);
    const double acceleration =
        std::max({part_of(room.cwiseMax(0.0), way_), std::abs(along_.a) - jerk, kTiny.share});
    along_.a =
        std::max(stop_change({kUnbounded, acceleration, jerk}, along_.v, along_.a), -along_.v);
    const double before = along_.v;
    along_.v += along_.a;
    straight_ = along_.v * way_ + across_.v * bend_;
    const double slower = before > 0.0 ? along_.v / before : 0.0;
    curve_ *= slower * slower;
    return straight_ + curve_;
  }

  JointVector each() const {
    JointVector step;
    for (int i = 0; i < kJoints; ++i) {
      step[i] = joints_.step[i] + stop_change(limits_.axis[static_cast<std::size_t>(i)],
                                              joints_.step[i], joints_.change[i]);
    }
    return step;
  }

  // Joints that slow together keep the tip's way, others only its space.
  bool keep_way(Stopping how, JointVector& q, Verdict& why) {
    const bool as_one = how == Stopping::kAsOne;
    const Vec3 before = p_;
    const Vec3 way = along_.v * p_way_ + across_.v * p_bend_;
    p_ = space_.nearest(as_one ? Vec3(p_ + way) : tip_.p());
    // A bend that ends does not take the tip back.
    for (const Vec3& forward_S : {way_S_, space_.forward_S}) {
      p_ -= std::min(0.0, forward_S.dot(p_ - before)) * forward_S;
    }
    if (!inverse_.bring_to(p_, tip_, q)) {
      why = {Reason::kSingularity, -1};
      return false;
    }
    // What the curve took now it takes again, with the square of the speed.
    if (as_one) curve_ = q - joints_.q - straight_;
    return true;
  }

  const PlanLimits& limits_;
  const TipSpace& space_;
  GuardState joints_;
  JointVector from_;         // where the stop begins [rad]
  Vec3 p_, p_way_, p_bend_;  // the tip, and its directions [m]
  Vec3 way_S_;               // unit, or zero: the tip's way
  TipPlace tip_;
  PlaceInverse inverse_;
  JointVector way_, bend_;                   // the joints' directions [rad]
  JointVector straight_;                     // their step along these [rad]
  JointVector curve_ = JointVector::Zero();  // what keeping to the tool took last [rad]
  AxisState along_, across_;                 // how far, how fast, in units of them
  double across_jerk_ = 0.0;
};

}  // namespace

PlanLimits::PlanLimits(const GuardLimits& of) noexcept : guard(of), axis(of.axis) {
  for (int i = 0; i < kJoints; ++i) {
    AxisLimits& l = axis[static_cast<std::size_t>(i)];
    l.acceleration *= kMotion.plan_share;
    l.jerk *= kMotion.plan_share;
    from_end[i] = kStopReachOver * l.acceleration + kTiny.from_end;
    const double stoppable = StopPlan::kCapacity - 1 - bend_time(l);  // [cycles]
    l.speed = std::min(kMotion.plan_share * l.speed, stoppable * l.acceleration);
    speed[i] = l.speed;
    acceleration[i] = l.acceleration;
    jerk[i] = l.jerk;
  }
  // The box of a step looks at a range's end from so much further off.
  const JointVector off = guard.plenty + 2.0 * speed + JointVector::Constant(kTiny.past);
  planned = {speed, acceleration, jerk, jerk.cwiseInverse(), guard.lower + off, guard.upper - off};
  sent = {kSent * speed,     kSent * acceleration, kSent * jerk, (kSent * jerk).cwiseInverse(),
          guard.plain_lower, guard.plain_upper};
}

Verdict plan_allows(const PlanLimits& limits, const GuardState& state,
                    const JointVector& wanted) noexcept {
  const JointVector step = wanted - state.q, change = step - state.step;
  if (wanted.allFinite() && limits.sent.plainly_hold(wanted, step, change, state.change)) {
    return guard_allows_tip(limits.guard, state, wanted, step, change);
  }
  // NaN is over, too.
  const auto over = [](const JointVector& value, const JointVector& limit) {
    return !((value.cwiseAbs() - kSent * limit).maxCoeff() <= 0.0);
  };
  if (over(step, limits.speed)) return {Reason::kJointSpeed, -1};
  if (over(change, limits.acceleration)) return {Reason::kJointAcceleration, -1};
  if (over(change - state.change, limits.jerk)) return {Reason::kJointJerk, -1};
  // With the guard's own limits: its bound on reach is not the larger for smaller ones.
  return guard_allows(limits.guard, state, wanted);
}

void advance(const PlanLimits& limits, GuardState& state, const JointVector& wanted) noexcept {
  const JointVector step = wanted - state.q;
  state.clearance -= limits.guard.lever.dot(step.cwiseAbs());
  state.change = step - state.step;
  state.step = step;
  state.q = wanted;
}

void PlaceInverse::turn_around(const TipPlace& tip) noexcept {
  const auto J = tip.jacobian().linear;
  const JointVector weight = limits_.acceleration.cwiseAbs2();
  const Eigen::Matrix<double, kJoints, 3> WJt = weight.asDiagonal() * J.transpose();
  const Mat3 H = J * WJt;
  // Bounded where the tip cannot go some way.
  R_ = WJt * (H + kTiny.share * H.trace() * Mat3::Identity()).inverse();
}

bool PlaceInverse::bring_to(const Vec3& p, TipPlace& tip, JointVector& q) noexcept {
  for (int i = 0; i < kTiny.corrections; ++i) {
    const Vec3 off = p - tip.p();
    if (off.squaredNorm() < kTiny.off * kTiny.off) return true;
    if (!known_ || i == kTiny.corrections / 2) turn_around(tip);
    known_ = true;
    const JointVector by = R_ * off;
    q += by;
    tip.turn(by);
  }
  return false;
}

bool plan_stop(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
               const TipPlace& tip, Stopping how, StopPlan& plan, Verdict& why) noexcept {
  plan.size = plan.next = 0;
  plan.p_end = from.X_ST.p;
  if (from.joints.step.isZero(0.0) && from.joints.change.isZero(0.0)) return true;
  return RollOut(limits, space, from, tip).run(how, plan, why);
}

}  // namespace handrail
