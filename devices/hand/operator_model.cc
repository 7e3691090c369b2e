#include "devices/hand/operator_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

// Of a tolerance: motion still under way that no longer matters for calling an aim reached.
constexpr double kUnderWay = 0.5;
// Of the advance meant by a plan: a tip that moved less has been stopped.
constexpr double kStopped = 0.1;

Vec3 normal3(Random& random) noexcept {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

}  // namespace

HandOptions hand_options(const OperatorParameters& parameters, std::uint64_t seed) noexcept {
  HandOptions hand;
  hand.seed = seed;
  hand.mass = parameters.mass;
  hand.stiffness = parameters.stiffness;
  hand.damping_ratio = parameters.damping_ratio;
  hand.tremor_rms = parameters.tremor;
  hand.drift_rms = parameters.drift;
  hand.drift_rotation_rms = parameters.drift_angle;
  hand.turn_lever = parameters.turn_lever;
  hand.reaction = 0.0;
  return hand;
}

OperatorModel::OperatorModel(const OperatorParameters& parameters, const OperatorMachine& machine,
                             std::uint64_t seed) noexcept
    : parameters_(parameters), machine_(machine), random_(seed), intent_(0.0) {
  vision_noise_ = {parameters.vision_noise_lateral, parameters.vision_noise_lateral,
                   parameters.vision_noise_depth};
  noise_kept_ = std::exp(-kGlance / parameters.vision_noise_time);
  misjudged_ = vision_noise_.cwiseProduct(normal3(random_));
  misjudged_turn_ = parameters.vision_noise_angle * normal3(random_);
}

void OperatorModel::aim(const OperatorAim& aim) noexcept {
  aim_ = aim;
  aiming_ = true;
  arrived_ = false;
  near_stop_ = felt_ = false;
  felt_for_ = told_ = 0.0;
  homing_for_ = 0.0;
  to_plan_ = 0.0;
}

void OperatorModel::leave_off(SteerableHand& hand) noexcept {
  aiming_ = false;
  goal_p_ = intent_.position().p;
  goal_q_ = intent_.orientation();
  steer(hand);
}

void OperatorModel::step(double dt, const Pose& X_ST, const Vec3& f_H_M,
                         SteerableHand& hand) noexcept {
  intent_.step(dt);
  to_glance_ -= dt;
  if (to_glance_ <= 0.0) {
    to_glance_ += kGlance;
    glance(X_ST);
  }
  if (!aiming_) return;
  feel(dt, f_H_M, hand);
  to_plan_ -= dt;
  if (to_plan_ > 0.0) return;
  to_plan_ += parameters_.plan_interval;
  plan(hand);
}

// Stores what is seen and intended, and lets the errors of judgement wander (first order, exact).
void OperatorModel::glance(const Pose& X_ST) noexcept {
  memory_[glances_++ % kGlances] = {X_ST, intent_.position().p, intent_.orientation()};
  const double fresh = std::sqrt(1.0 - noise_kept_ * noise_kept_);
  misjudged_ = noise_kept_ * misjudged_ + fresh * vision_noise_.cwiseProduct(normal3(random_));
  misjudged_turn_ =
      noise_kept_ * misjudged_turn_ + fresh * parameters_.vision_noise_angle * normal3(random_);
}

const OperatorModel::Glance& OperatorModel::before(double seconds) const noexcept {
  const auto ago = static_cast<std::size_t>(std::lround(seconds / kGlance));
  return memory_[(glances_ - 1 - std::min({ago, glances_ - 1, kGlances - 1})) % kGlances];
}

// A stop is felt when it pushes back, where it is expected, for long enough to react; what was
// pushed into it is let go. A push by hand is not, only ended.
void OperatorModel::feel(double dt, const Vec3& f_H_M, SteerableHand& hand) noexcept {
  if (!near_stop_ || felt_) return;
  const Vec3 forward = machine_.q_SM.conjugate() * (aim_.X_SG.p - aim_.p_S0).normalized();
  felt_for_ = -f_H_M.dot(forward) > parameters_.stop_force ? felt_for_ + dt : 0.0;
  if (felt_for_ < parameters_.touch_delay) return;
  felt_ = true;
  goal_p_ = intent_.position().p;
  if (aim_.stop) goal_p_ += f_H_M / parameters_.stiffness;
  steer(hand);
}

Vec3 OperatorModel::seen() const noexcept {
  return before(parameters_.vision_delay).X_ST.p + machine_.q_SM * misjudged_;
}

void OperatorModel::plan(SteerableHand& hand) noexcept {
  const OperatorParameters& p = parameters_;
  const Glance& glance = before(p.vision_delay);
  const Glance& cause = before(p.vision_delay + machine_.lag);  // what made the tip be there
  // What was set going since, at the tip.
  const Vec3 coming = machine_.scale * (machine_.q_SM * (goal_p_ - cause.p_M));
  const Vec3 coming_turn = machine_.q_SM * rotation_log(goal_q_ * cause.q_M.conjugate());
  const Vec3 p_seen = seen();
  const Quat q_expected =
      rotation_exp(machine_.q_SM * misjudged_turn_) * rotation_exp(coming_turn) * glance.X_ST.q;

  const Vec3 turn = wanted_turn(rotation_log(aim_.X_SG.q * q_expected.conjugate()));
  Vec3 step = Vec3::Zero();
  if (aim_.stop) {
    if (!felt_) step = wanted_step(p_seen + coming);
    arrived_ = arrived_ || stopped(p_seen);
  } else if (aim_.by_hand) {
    const Vec3 way = aim_.X_SG.p - aim_.p_S0;
    const bool all_told = told_ >= way.norm();
    step = wanted_step(p_seen + coming);
    arrived_ =
        (felt_ || all_told) && std::abs(coming.dot(way.normalized())) < kUnderWay * tolerance();
  } else {
    step = wanted_step(p_seen + coming);
    arrived_ = step.isZero(0.0) && turn.isZero(0.0) &&
               (aim_.minds_place * coming).norm() <= kUnderWay * tolerance() &&
               (aim_.minds_turn * coming_turn).norm() <= kUnderWay * angle_tolerance();
  }
  if (step.isZero(0.0) && turn.isZero(0.0)) return;
  goal_p_ += machine_.q_SM.conjugate() * missed(step) / machine_.scale;
  goal_q_ = (rotation_exp(machine_.q_SM.conjugate() * missed(turn)) * goal_q_).normalized();
  steer(hand);
}

// The correction of the tip's expected place to ask for now, frame S [m].
Vec3 OperatorModel::wanted_step(const Vec3& p_expected) noexcept {
  const OperatorParameters& p = parameters_;
  const Vec3 error = aim_.minds_place * (aim_.X_SG.p - p_expected);
  const double advance = (aim_.speed > 0.0 ? aim_.speed : p.speed) * p.plan_interval;
  const Vec3 forward = aim_.path ? (aim_.X_SG.p - aim_.p_S0).normalized() : Vec3(Vec3::Zero());
  if (aim_.by_hand) {
    near_stop_ = true;
    const double to_go = felt_ ? 0.0 : (aim_.X_SG.p - aim_.p_S0).norm() - told_;
    const double hurry = std::min(p.speed * p.plan_interval, to_go - aim_.gentle);
    const double now = std::min(to_go, std::max(hurry, advance));
    told_ += now;
    const Vec3 aside = error - error.dot(forward) * forward;
    return now * forward + (aside.norm() > p.threshold ? p.gain * aside : Vec3(Vec3::Zero()));
  }
  const double left = error.dot(forward);
  const bool under_way = aim_.path && (aim_.stop || std::abs(left) > advance);
  if (!under_way) {
    homing_for_ += p.plan_interval;
    return error.norm() > tolerance() ? Vec3(p.gain * error) : Vec3(Vec3::Zero());
  }
  near_stop_ = aim_.stop && left < advance;
  // Toward a stop there is no turning back: the tool does not let the tip go past it.
  const Vec3 along = (aim_.stop ? advance : std::copysign(advance, left)) * forward;
  const Vec3 across = error - left * forward;
  return along + (across.norm() > p.threshold ? p.gain * across : Vec3(Vec3::Zero()));
}

// The correction of orientation to ask for now, rotation vector in S [rad].
Vec3 OperatorModel::wanted_turn(const Vec3& shorter) const noexcept {
  const OperatorParameters& p = parameters_;
  const bool back = shorter.dot(aim_.way_round) < 0.0 && shorter.norm() > 0.5 * std::numbers::pi;
  const Vec3 error =
      aim_.minds_turn *
      (back ? Vec3((1.0 - 2.0 * std::numbers::pi / shorter.norm()) * shorter) : shorter);
  const double angle = error.norm();
  if (angle <= angle_tolerance()) return Vec3::Zero();
  const double advance = (aim_.turn_speed > 0.0 ? aim_.turn_speed : p.turn_speed) * p.plan_interval;
  return error * (angle > advance ? advance / angle : p.gain);
}

// True when the tip is seen to stand: at a stop that was felt, or pushed on and near the end.
bool OperatorModel::stopped(const Vec3& p_seen) const noexcept {
  const OperatorParameters& p = parameters_;
  const Vec3 forward = (aim_.X_SG.p - aim_.p_S0).normalized();
  const Vec3 moved =
      before(p.vision_delay).X_ST.p - before(p.vision_delay + p.plan_interval).X_ST.p;
  return (felt_ || (aim_.X_SG.p - p_seen).dot(forward) < p.tolerance) &&
         moved.norm() < kStopped * p.speed * p.plan_interval;
}

// Where a step meant as `step` really leads.
Vec3 OperatorModel::missed(const Vec3& step) noexcept {
  const double rms_per_axis = parameters_.motor_noise * step.norm() / std::sqrt(3.0);
  return step + rms_per_axis * normal3(random_);
}

void OperatorModel::steer(SteerableHand& hand) noexcept {
  HandIntent move;
  move.displacement_M = goal_p_ - intent_.position().p;
  move.rotation_M = rotation_log(goal_q_ * intent_.orientation().conjugate());
  move.duration = parameters_.submovement;
  intent_.steer(move);
  hand.steer(move);
}

}  // namespace handrail
