#include "server/lab/study/population.h"

#include <algorithm>
#include <cmath>

#include "server/base/fnv.h"
#include "server/base/units.h"

namespace handrail {
namespace {

using P = OperatorParameters;
constexpr double kMs = 1e-3;  // [s] in a millisecond

}  // namespace

const std::vector<ParameterInfo>& operator_parameter_table() {
  static const std::vector<ParameterInfo> table = {
      {&P::vision_delay, "vision_delay_ms", kMs, 0, 1000},
      {&P::vision_noise_lateral, "vision_noise_lateral_mm", kMm, 0, 100},
      {&P::vision_noise_depth, "vision_noise_depth_mm", kMm, 0, 100},
      {&P::vision_noise_angle, "vision_noise_angle_deg", kDeg, 0, 45},
      {&P::vision_noise_time, "vision_noise_time_s", 1.0, 0.05, 100},
      {&P::plan_interval, "plan_interval_ms", kMs, 20, 2000},
      {&P::submovement, "submovement_ms", kMs, 20, 5000},
      {&P::speed, "speed_mm_s", kMm, 1, 1000},
      {&P::turn_speed, "turn_speed_deg_s", kDeg, 1, 360},
      {&P::gain, "gain", 1.0, 0.01, 1.5},
      {&P::threshold, "threshold_mm", kMm, 0, 100},
      {&P::angle_threshold, "angle_threshold_deg", kDeg, 0.01, 45},
      {&P::tolerance, "tolerance_mm", kMm, 0.01, 100},
      {&P::patience, "patience_s", 1.0, 0.1, 1000},
      {&P::pause, "pause_s", 1.0, 0, 60},
      {&P::practice, "practice", 1.0, 0, 1},
      {&P::motor_noise, "motor_noise", 1.0, 0, 1},
      {&P::tremor, "tremor_mm", kMm, 0, 2},
      {&P::drift, "drift_mm", kMm, 0, 10},
      {&P::drift_angle, "drift_angle_deg", kDeg, 0, 20},
      {&P::turn_lever, "turn_lever_mm", kMm, 0, 100},
      {&P::mass, "mass_kg", 1.0, 0.01, 5},
      {&P::stiffness, "stiffness_n_mm", kNewtonPerMm, 0.01, 5},
      {&P::damping_ratio, "damping_ratio", 1.0, 0, 5},
      {&P::call_homing, "call_homing_ms", kMs, 0, 10000},
      {&P::call_key, "call_key_ms", kMs, 0, 10000},
      {&P::stop_force, "stop_force_n", 1.0, 0.01, 50},
      {&P::touch_delay, "touch_delay_ms", kMs, 0, 1000},
      {&P::insert_tolerance, "insert_tolerance_mm", kMm, 0.01, 100, true},
      {&P::insert_speed, "insert_speed_mm_s", kMm, 1, 1000, true},
      {&P::press, "press_mm", kMm, 0, 20, true},
      {&P::depth_memory, "depth_memory", 1.0, 0, 1, true},
      {&P::half_turn, "half_turn_deg", kDeg, 10, 240, true},
      {&P::lift, "lift_mm", kMm, 1, 100, true},
  };
  return table;
}

ParameterRange* Population::find(std::string_view parameter_name) {
  const auto it = std::find_if(parameters.begin(), parameters.end(),
                               [&](const ParameterRange& p) { return p.name == parameter_name; });
  return it == parameters.end() ? nullptr : &*it;
}

OperatorParameters Population::draw(Random& random) const {
  OperatorParameters out;
  const std::uint64_t person = random.bits();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterRange& p = parameters[i];
    Random own(Fnv().u64(person).u64(i).value());
    out.*p.field = std::clamp(p.median * std::exp(p.spread * own.normal()), p.low, p.high);
  }
  return out;
}

OperatorParameters Population::median() const {
  OperatorParameters out;
  for (const ParameterRange& p : parameters) out.*p.field = p.median;
  return out;
}

}  // namespace handrail
