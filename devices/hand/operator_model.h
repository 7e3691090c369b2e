// A simulated operator: it looks at the tip, decides, and steers the hand. Simulated: results
// obtained with it must be labelled so.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "devices/hand/hand_model.h"
#include "devices/hand/hand_motion.h"
#include "devices/hand/operator_parameters.h"
#include "devices/haptic_device.h"
#include "server/base/random.h"
#include "server/base/spatial.h"

namespace handrail {

// What the operator tries to do, frame S.
struct OperatorAim {
  Pose X_SG;                 // where the tip shall be
  Vec3 p_S0 = Vec3::Zero();  // with `path`: where the straight path to it begins [m]
  bool path = false;         // keep to the path at the preferred speed; else get there
  bool stop = false;  // a tool stops the tip at the end of the path: push on until that is felt
  // With `path`: how far the tip is along it is known from the hand alone, as where the tip cannot
  // be seen to advance or is held up. Ends when the hand has gone that far, or is pushed back.
  bool by_hand = false;
  Vec3 way_round =
      Vec3::Zero();     // unit axis, frame S: to be turned about it; zero: the shorter way
  double speed = 0.0;   // along a path [m/s]; 0: the preferred one
  double gentle = 1.0;  // by hand: the last part of it goes at `speed`, before at the preferred [m]
  double turn_speed = 0.0;  // [rad/s]; 0: the preferred one
  double tolerance = 0.0;   // seen distance that counts as arrived [m]; 0: the person's own
  // Which errors of place and orientation are minded, projections in S. What a tool holds is left
  // to the tool: errors that do not matter are not corrected (Todorov and Jordan 2002).
  Mat3 minds_place = Mat3::Identity();
  Mat3 minds_turn = Mat3::Identity();
};

// What the operator has learned of the machine by practice.
struct OperatorMachine {
  double scale = 2.0;            // tip motion for hand motion
  Quat q_SM = Quat::Identity();  // device axes in S
  double lag = 0.15;             // from hand to tip [s], 0 to 0.6
};

// The mind of a simulated operator. Every `plan_interval` it takes what it saw of the tip
// `vision_delay` ago, blurred by slow errors of judgement, adds what it knows to have set going
// since (its own copy of the intended motion), and compares with the aim. Errors beyond the
// thresholds start a minimum-jerk submovement (Flash and Hogan 1985) whose end misses by signal-
// dependent noise (Harris and Wolpert 1998); running ones are bent into the new goal. Repeated
// partial corrections are what makes aiming obey Fitts' law (Crossman and Goodeve 1963). The body,
// with grip, tremor and drift, is HandModel.
//
// Pure: fixed state, no allocation, no clock; same seed and calls, same bits.
class OperatorModel {
 public:
  // Line of sight: along the device's Z.
  OperatorModel(const OperatorParameters& parameters, const OperatorMachine& machine,
                std::uint64_t seed) noexcept;

  // Takes up an aim at once; deciding about it is the caller's business.
  void aim(const OperatorAim& aim) noexcept;

  // Leaves off: the hand comes to rest on the spot.
  void leave_off(SteerableHand& hand) noexcept;

  // Lets dt pass, 0 < dt <= 10 ms. `X_ST`: the tip now. `f_H_M`: force on the hand now [N]. Steers
  // `hand`, whose intent nobody else may steer and whose own reaction delay is zero.
  void step(double dt, const Pose& X_ST, const Vec3& f_H_M, SteerableHand& hand) noexcept;

  // True from when the operator holds the aim to be reached: it sees tip and orientation within its
  // tolerances with nothing left under way, or sees the tip stand at a stop it felt or expected.
  bool arrived() const noexcept { return arrived_; }

  // During an aim by hand or at a stop: something has pushed back.
  bool felt() const noexcept { return felt_; }
  // Where the tip seems to be now: late and misjudged, frame S [m].
  Vec3 seen() const noexcept;
  // Where the hand is meant to end, at the tip's scale from where it began, frame S [m].
  Vec3 meant() const noexcept { return machine_.scale * (machine_.q_SM * goal_p_); }

  const OperatorParameters& parameters() const noexcept { return parameters_; }

 private:
  static constexpr double kGlance = 5e-3;       // between stored glances [s]
  static constexpr std::size_t kGlances = 512;  // 2.56 s: longer than any delay and lag together
  struct Glance {
    Pose X_ST;                // as it was, without errors of judgement
    Vec3 p_M = Vec3::Zero();  // intended hand
    Quat q_M = Quat::Identity();
  };

  void glance(const Pose& X_ST) noexcept;
  const Glance& before(double seconds) const noexcept;
  void feel(double dt, const Vec3& f_H_M, SteerableHand& hand) noexcept;
  void plan(SteerableHand& hand) noexcept;
  Vec3 wanted_step(const Vec3& p_expected) noexcept;
  Vec3 wanted_turn(const Vec3& shorter) const noexcept;
  // Nobody is picky for ever: a tolerance grows while the operator homes in.
  double tolerance() const noexcept {
    return tolerated(aim_.tolerance > 0.0 ? aim_.tolerance
                                          : share(aim_.minds_place) * parameters_.tolerance);
  }
  double angle_tolerance() const noexcept {
    return tolerated(share(aim_.minds_turn) * parameters_.angle_threshold);
  }
  // Of an error of all three axes together, as RMS: that of the axes that are minded.
  static double share(const Mat3& minded) noexcept { return std::sqrt(minded.trace() / 3.0); }
  double tolerated(double tolerance) const noexcept {
    return tolerance * (1.0 + homing_for_ / parameters_.patience);
  }
  bool stopped(const Vec3& p_seen) const noexcept;
  Vec3 missed(const Vec3& step) noexcept;
  void steer(SteerableHand& hand) noexcept;

  OperatorParameters parameters_;
  OperatorMachine machine_;
  Random random_;
  Vec3 vision_noise_ = Vec3::Zero();  // RMS of each axis, frame M, tip scale [m]
  double noise_kept_ = 0.0;           // from one glance to the next
  HandMotion intent_;                 // its own copy of what it asked of the hand
  Vec3 goal_p_ = Vec3::Zero();        // where the intent will end, frame M [m]
  Quat goal_q_ = Quat::Identity();
  OperatorAim aim_;
  bool aiming_ = false;
  bool arrived_ = false;
  double told_ = 0.0;                   // the hand to go along the path, since the aim [m]
  bool near_stop_ = false;              // as expected at the last plan
  double homing_for_ = 0.0;             // aiming at the end point itself [s]
  bool felt_ = false;                   // the stop
  double felt_for_ = 0.0;               // the stop's force, without a break [s]
  Vec3 misjudged_ = Vec3::Zero();       // position, frame M, in tip scale [m]
  Vec3 misjudged_turn_ = Vec3::Zero();  // orientation, frame M [rad]
  double to_glance_ = 0.0;
  double to_plan_ = 0.0;
  std::size_t glances_ = 0;
  std::array<Glance, kGlances> memory_;
};

// The hand of an operator with these parameters.
HandOptions hand_options(const OperatorParameters& parameters, std::uint64_t seed) noexcept;

}  // namespace handrail
