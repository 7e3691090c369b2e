// A simulated operator at a machine that follows the hand at once, one to one.
#pragma once

#include <memory>

#include "devices/hand/operator_model.h"

namespace handrail::test {

inline constexpr double kTick = 1e-3;

// An operator without noise.
inline OperatorParameters steady() {
  OperatorParameters p;
  p.vision_noise_lateral = p.vision_noise_depth = p.vision_noise_angle = 0.0;
  p.motor_noise = p.tremor = p.drift = p.drift_angle = p.turn_lever = 0.0;
  p.gain = 0.7;
  return p;
}

// The tip is where the hand means it to be, plus what is pushed on it from outside.
class Desk {
 public:
  explicit Desk(const OperatorParameters& p, std::uint64_t seed = 1)
      : mind_(std::make_unique<OperatorModel>(p, OperatorMachine{1.0, Quat::Identity(), 0.0},
                                              seed)) {}

  void aim(const OperatorAim& aim) { mind_->aim(aim); }
  void reach(const Vec3& p, const Quat& q = Quat::Identity()) {
    OperatorAim aim;
    aim.X_SG = {p, q};
    mind_->aim(aim);
  }
  void tick() {
    hand_.step(kTick);
    tip_.p = held_ ? tip_.p : Vec3(hand_.position().p + pushed_);
    tip_.q = hand_.orientation();
    mind_->step(kTick, tip_, force_, hand_steered_);
    now_ += kTick;
  }
  // Ticks until the operator calls it reached; how long that took [s].
  double until_arrived(double most = 60.0) {
    const double start = now_;
    do tick();
    while (!mind_->arrived() && now_ - start < most);
    return now_ - start;
  }

  HandMotion hand_{0.0};
  struct Steered final : SteerableHand {
    explicit Steered(HandMotion& hand) : motion(hand) {}
    void steer(const HandIntent& intent) noexcept override {
      motion.steer(intent);
      ++orders;
    }
    bool moving() const noexcept override { return motion.moving(); }
    HandMotion& motion;
    int orders = 0;
  } hand_steered_{hand_};
  std::unique_ptr<OperatorModel> mind_;
  Pose tip_;
  Vec3 pushed_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();
  bool held_ = false;
  double now_ = 0.0;
};

}  // namespace handrail::test
