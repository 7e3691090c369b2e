#include <algorithm>
#include <functional>
#include <memory>

#include "devices/omni/sim_omni.h"
#include "server/lab/scenes/contest.h"
#include "server/lab/scenes/explain_price.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;  // [s]
constexpr int kTurns = 60, kBatches = 64, kCalls = 16;

// Where the hand is at tick `i`, frame S: a slow figure, so that nothing rests.
Pose hand_at(int i) {
  const double t = kTick * i;
  Pose out;
  out.p = Vec3(0.35, 0.0375, 0.329) +
          0.02 * Vec3(std::sin(3.0 * t), std::sin(4.0 * t), std::cos(5.0 * t));
  out.q = rotation_exp(Vec3(0.1 * std::sin(2.0 * t), 0.0, 0.1 * std::cos(3.0 * t)));
  return out;
}

// That hand, over and over.
class Hands {
 public:
  Hands() {
    for (int i = 0; i < 4096; ++i) all_.push_back(hand_at(i));
  }
  const Pose& first() const { return all_[0]; }
  const Pose& next() {
    const Pose& hand = all_[next_];
    next_ = (next_ + 1) % all_.size();
    return hand;
  }

 private:
  std::vector<Pose> all_;
  std::size_t next_ = 0;
};

// The guide with the tools the task calls, or without one of them.
std::function<void()> guide(const Scene& scene, bool position, bool orientation) {
  struct State {
    GuideSettings settings;
    Guide guide;
    Hands hands;
  };
  auto s = std::make_shared<State>();
  s->settings = haptic_settings(scene, omni_capabilities(false)).guide;
  Pose hand = s->hands.first();
  s->guide.restart(s->settings, hand);
  ToolCall call;
  call.kind = ToolKind::kLine;
  call.direction_S = -Vec3::UnitY();
  if (position) (void)s->guide.call(s->settings, call, hand.p, hand);
  call.kind = ToolKind::kNRotation;
  if (orientation) (void)s->guide.call(s->settings, call, hand.p, hand);
  return [s] {
    for (int i = 0; i < kCalls; ++i) keep(s->guide.step(s->settings, s->hands.next(), kTick));
  };
}

std::function<void()> smoother(const Scene& scene) {
  struct State {
    PositionSmoother position;
    OrientationSmoother orientation;
    Hands hands;
  };
  auto s = std::make_shared<State>();
  s->position.reset(s->hands.first().p, scene.smoother_samples);
  s->orientation.reset(s->hands.first().q, scene.smoother_samples);
  return [s] {
    for (int i = 0; i < kCalls; ++i) {
      const Pose& hand = s->hands.next();
      keep(s->position.push(hand.p));
      keep(s->orientation.push(hand.q));
    }
  };
}

std::function<void()> hand(double tremor, double drift, double drift_rotation) {
  HandOptions options;
  options.tremor_rms = tremor;
  options.drift_rms = drift;
  options.drift_rotation_rms = drift_rotation;
  auto model = std::make_shared<HandModel>(options);
  return [model] {
    Wrench wrench;
    wrench.force.x() = 0.1;
    for (int i = 0; i < kCalls; ++i) model->step(kTick, wrench);
    keep(model->pose());
  };
}

std::function<void()> device() {
  struct State {
    SimOmni omni{HandOptions(), false};
    Nanos now = 0;
  };
  auto s = std::make_shared<State>();
  (void)s->omni.open();
  return [s] {
    for (int i = 0; i < kCalls; ++i) {
      s->now += kMillisecond;
      keep(s->omni.read(s->now));
    }
  };
}

}  // namespace

std::vector<PricedEffect> price_of_arm(const Scene& scene, const std::atomic<bool>& cancelled) {
  const auto nothing = [] {};
  const HandOptions h;
  Contest contest;
  std::vector<PricedEffect> out;
  const auto enter = [&](const char* name, bool on_rig, const std::function<void()>& with,
                         const std::function<void()>& without) {
    contest.add([] {}, with, kCalls);
    contest.add([] {}, without, kCalls);
    out.push_back({name, on_rig});
  };
  enter("position_tool", false, guide(scene, true, true), guide(scene, false, true));
  enter("orientation_tool", false, guide(scene, true, true), guide(scene, true, false));
  enter("smoother", false, smoother(scene), nothing);
  enter("hand_impedance", true, hand(0.0, 0.0, 0.0), nothing);
  enter("hand_tremor", true, hand(h.tremor_rms, 0.0, 0.0), hand(0.0, 0.0, 0.0));
  enter("hand_drift", true, hand(0.0, h.drift_rms, h.drift_rotation_rms), hand(0.0, 0.0, 0.0));
  enter("device", true, device(), hand(h.tremor_rms, h.drift_rms, h.drift_rotation_rms));
  contest.run(kTurns, kBatches, cancelled);
  if (cancelled) return {};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].ns_per_tick = std::max(contest.longer(2 * i, 2 * i + 1), 0.0);
  }
  return out;
}

}  // namespace handrail
