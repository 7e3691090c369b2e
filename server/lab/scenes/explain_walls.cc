#include <algorithm>
#include <array>
#include <memory>

#include "devices/joystick/sim_joystick.h"
#include "server/lab/scenes/contest.h"
#include "server/lab/scenes/explain_price.h"
#include "server/lab/scenes/view.h"
#include "server/master/haptic_settings.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

constexpr double kWallTick = 1e-3;  // [s]
constexpr double kWander = 8.0;     // [s]
constexpr double kMargin = 5e-3;    // beyond drawn shapes [m]
// A price depends by some nanoseconds on where in memory things happen to lie: the median over
// several builds.
constexpr int kRounds = 7;
constexpr int kWallTurns = 60, kWallBatches = 64, kWallCalls = 16;

// The hand of the first stage at `t`, frame M.
Vec2 target_at(const Scene& scene, const View& view, double t) {
  const Vec2 p = scene.walls->stages[0].pose.to_world(wander(*scene.walls, view, t));
  return p.cwiseMax(-kJoystickHalf).cwiseMin(kJoystickHalf);
}

Scene without_effect(const Scene& scene, std::size_t effect) {
  Scene out = scene;
  out.effects.erase(out.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return out;
}

// The master's step of a scene, given readings round and round.
class Stepper {
 public:
  Stepper(const Scene& scene, const std::vector<HandReading>& hands)
      : hands_(hands), run_(make_wall_run(scene, joystick_capabilities())) {}
  void batch() {
    for (int i = 0; i < kWallCalls; ++i) {
      in_.hand = hands_[next_];
      next_ = (next_ + 1) % hands_.size();
      wall_step(run_->settings, in_, kWallTick, run_->state, out_);
    }
    keep(out_);
  }

 private:
  const std::vector<HandReading>& hands_;
  std::unique_ptr<WallRun> run_;
  WallInput in_;
  WallOutput out_;
  std::size_t next_ = 0;
};

// The simulated joystick of a scene, its hand going where wandering takes it.
class Stick {
 public:
  Stick(const Scene& scene, const std::vector<HandReading>& hands)
      : hands_(hands), device_(joystick_grip(), device_effects(scene.effects)) {
    (void)device_.open();
  }
  void batch() {
    Wrench wrench;
    for (int i = 0; i < kWallCalls; ++i) {
      const Vec3& p = hands_[next_].X_MH.p;
      next_ = (next_ + 1) % hands_.size();
      device_.follow(Vec2(p.x(), p.y()), Vec2::Zero());
      now_ += kMillisecond;
      // Some force, as walls give it.
      wrench.force = 200.0 * (p - device_.read(now_).X_MH.p);
      device_.write(wrench);
    }
    keep(wrench);
  }

 private:
  const std::vector<HandReading>& hands_;
  SimJoystick device_;
  Nanos now_ = 0;
  std::size_t next_ = 0;
};

// With everything built afresh.
std::vector<PricedEffect> price_once(const Scene& scene, const std::vector<HandReading>& hands,
                                     const std::atomic<bool>& cancelled) {
  Contest steps, sticks;
  const auto enter = [&hands](Contest& contest, auto entrant) {
    contest.add([] {}, [entrant] { entrant->batch(); }, kWallCalls);
  };
  enter(steps, std::make_shared<Stepper>(scene, hands));
  enter(sticks, std::make_shared<Stick>(scene, hands));
  std::vector<PricedEffect> out;
  std::vector<std::size_t> place;  // of the run without it
  std::size_t step_count = 1, stick_count = 1;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectKind kind = scene.effects[i].kind;
    PricedEffect effect;
    effect.name = name_of(kind);
    effect.on_rig = is_of_device(kind);
    if (effect.on_rig) {
      enter(sticks, std::make_shared<Stick>(without_effect(scene, i), hands));
    } else {
      enter(steps, std::make_shared<Stepper>(without_effect(scene, i), hands));
    }
    place.push_back(effect.on_rig ? stick_count++ : step_count++);
    out.push_back(effect);
  }
  if (step_count > 1) steps.run(kWallTurns, kWallBatches, cancelled);
  if (stick_count > 1) sticks.run(kWallTurns, kWallBatches, cancelled);
  if (cancelled) return {};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Contest& contest = out[i].on_rig ? sticks : steps;
    out[i].ns_per_tick = std::max(contest.longer(0, place[i]), 0.0);
  }
  return out;
}

}  // namespace

std::vector<HandReading> wander_through(const Scene& scene, double seconds) {
  const View view = view_of(*scene.walls, kMargin);
  SimJoystick stick(joystick_grip(), device_effects(scene.effects));
  (void)stick.open();
  const auto run = make_wall_run(scene, stick.capabilities());
  WallInput in;
  WallOutput out;
  std::vector<HandReading> hands;
  Nanos now = 0;
  for (double t = 0.0; t < seconds; t += kWallTick, now += kMillisecond) {
    const Vec2 p = target_at(scene, view, t);
    stick.follow(p, (target_at(scene, view, t + kWallTick) - p) / kWallTick);
    in.hand = hand_reading(stick.read(now));
    wall_step(run->settings, in, kWallTick, run->state, out);
    stick.write(out.f_H_M);
    hands.push_back(in.hand);
  }
  return hands;
}

std::vector<PricedEffect> price_of_walls(const Scene& scene, const std::atomic<bool>& cancelled) {
  const std::vector<HandReading> hands = wander_through(scene, kWander);
  std::vector<std::vector<PricedEffect>> rounds;
  for (int i = 0; i < kRounds && !cancelled; ++i) {
    rounds.push_back(price_once(scene, hands, cancelled));
  }
  if (cancelled) return {};
  std::vector<PricedEffect> out = rounds[0];
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::array<double, kRounds> prices{};
    for (std::size_t k = 0; k < prices.size(); ++k) prices[k] = rounds[k][i].ns_per_tick;
    std::nth_element(prices.begin(), prices.begin() + kRounds / 2, prices.end());
    out[i].ns_per_tick = prices[kRounds / 2];
  }
  return out;
}

}  // namespace handrail
