#include "server/lab/scenes/effect_price.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "devices/joystick/sim_joystick.h"

namespace handrail {
namespace {

constexpr int kBlock = 256;  // ticks timed at once: the clock's own cost is spread over them

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename F>
double block_ns(F&& tick) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kBlock; ++i) tick(i);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
  return took.count() / kBlock;
}

std::vector<EffectSpec> without(const std::vector<EffectSpec>& effects, std::size_t left_out) {
  std::vector<EffectSpec> out = effects;
  out.erase(out.begin() + static_cast<std::ptrdiff_t>(left_out));
  return out;
}

// The master's step, going through the motion again and again.
class StepUnderTest {
 public:
  StepUnderTest(const Scene& scene, const HapticCapabilities& device)
      : run_(make_wall_run(scene, device)) {}
  double block(const std::vector<HandReading>& motion, std::size_t from) {
    return block_ns([&](int i) {
      in_.hand = motion[(from + static_cast<std::size_t>(i)) % motion.size()];
      wall_step(run_->settings, in_, 1e-3, run_->state, out_);
    });
  }

 private:
  std::unique_ptr<WallRun> run_;
  WallInput in_;
  WallOutput out_;
};

class DeviceUnderTest {
 public:
  explicit DeviceUnderTest(const DeviceEffects& effects)
      : joystick_(std::make_unique<SimJoystick>(joystick_grip(), effects)) {
    (void)joystick_->open();
    joystick_->read(0);
  }
  double block(const std::vector<HandReading>&, std::size_t) {
    return block_ns([this](int) {
      const HapticSample sample = joystick_->read(now_ += kMillisecond);
      joystick_->write({-200.0 * sample.X_MH.p, Vec3::Zero()});
    });
  }

 private:
  std::unique_ptr<SimJoystick> joystick_;
  Nanos now_ = 0;
};

// The median of the first and by how much each of the others is shorter.
template <typename Tested>
std::vector<double> compare(std::vector<Tested>& all, const std::vector<HandReading>& motion,
                            int rounds) {
  std::vector<std::vector<double>> took(all.size());
  for (int round = 0; round < rounds; ++round) {
    const std::size_t from = static_cast<std::size_t>(round) * kBlock % motion.size();
    std::vector<double> now(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      // Nobody always goes first.
      const std::size_t which = (i + static_cast<std::size_t>(round)) % all.size();
      now[which] = all[which].block(motion, from);
    }
    took[0].push_back(now[0]);
    for (std::size_t i = 1; i < all.size(); ++i) took[i].push_back(now[0] - now[i]);
  }
  std::vector<double> out;
  for (const std::vector<double>& t : took) out.push_back(median(t));
  return out;
}

StepPrice price_once(const Scene& scene, const HapticCapabilities& device,
                     const std::vector<HandReading>& motion, int rounds) {
  StepPrice out;
  std::vector<StepUnderTest> steps;
  std::vector<DeviceUnderTest> devices;
  steps.emplace_back(scene, device);
  devices.emplace_back(device_effects(scene.effects));
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    out.effects.push_back({scene.effects[i].kind, 0.0});
    Scene less = scene;
    less.effects = without(scene.effects, i);
    if (is_of_device(scene.effects[i].kind)) {
      devices.emplace_back(device_effects(less.effects));
    } else {
      steps.emplace_back(less, device);
    }
  }
  const std::vector<double> step_ns = compare(steps, motion, rounds);
  const std::vector<double> device_ns = compare(devices, motion, rounds);
  out.step_ns = step_ns[0];
  out.device_ns = device_ns[0];
  std::size_t s = 1, d = 1;
  for (EffectPrice& price : out.effects) {
    price.ns = is_of_device(price.kind) ? device_ns[d++] : step_ns[s++];
  }
  return out;
}

}  // namespace

StepPrice price_effects(const Scene& scene, const HapticCapabilities& device,
                        const std::vector<HandReading>& motion, int rounds, int builds) {
  std::vector<StepPrice> all;
  for (int i = 0; i < builds; ++i) all.push_back(price_once(scene, device, motion, rounds));
  const auto middle = [&all](const auto& of) {
    std::vector<double> values;
    for (const StepPrice& price : all) values.push_back(of(price));
    return median(std::move(values));
  };
  StepPrice out = all.front();
  out.step_ns = middle([](const StepPrice& p) { return p.step_ns; });
  out.device_ns = middle([](const StepPrice& p) { return p.device_ns; });
  for (std::size_t i = 0; i < out.effects.size(); ++i) {
    out.effects[i].ns = middle([i](const StepPrice& p) { return p.effects[i].ns; });
  }
  return out;
}

}  // namespace handrail
