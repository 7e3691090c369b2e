#include "server/lab/study/study_setup_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devices/rig/rig_options_io.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/haptic/smoother.h"
#include "server/lab/study/population_io.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr double kSlowest = 100.0, kFastest = 5000.0;  // haptic rate [Hz]
// Fields of the rig that a study fills in, or that only its daemon uses.
constexpr const char* kSetByTheStudy[] = {"rig.seed", "rig.start_joints_deg", "rig.address",
                                          "rig.robot_port", "rig.sensor_port"};
constexpr double kLongestDelay = 200.0;  // [ms]

Status wrong(const Override& setting, const std::string& why) {
  return Status::error("--set " + setting.key + "=" + setting.value + ": " + why);
}

Status number_in(const Override& setting, double least, double most, const char* unit,
                 double& out) {
  const char* end = setting.value.data() + setting.value.size();
  const auto parsed = std::from_chars(setting.value.data(), end, out);
  if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(out)) {
    return wrong(setting, "'" + setting.value + "' is not a number");
  }
  if (out >= least && out <= most) return Status::ok();
  return wrong(setting, fmt::format("{} is outside {} to {}{}", setting.value, least, most, unit));
}

Status set_parameter(const Override& setting, const std::string& name, Population& population) {
  ParameterRange* parameter = population.find(name);
  const auto& table = operator_parameter_table();
  if (parameter == nullptr) {
    std::vector<std::string> names;
    for (const ParameterInfo& info : table) names.push_back(info.name);
    const std::string nearest = nearest_name(name, names);
    return wrong(setting, "no such parameter of the operator" +
                              (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  const auto info = std::find_if(table.begin(), table.end(),
                                 [&](const ParameterInfo& i) { return i.name == name; });
  double value = 0.0;
  if (Status s = number_in(setting, info->least, info->most, "", value); !s) return s;
  parameter->median = value * info->unit;
  parameter->low = std::min(parameter->low, parameter->median);
  parameter->high = std::max(parameter->high, parameter->median);
  return Status::ok();
}

Status set_rate(const Override& setting, StudyMachine& machine) {
  double rate = 0.0;
  if (Status s = number_in(setting, kSlowest, kFastest, " Hz", rate); !s) return s;
  machine.tick = std::llround(1e9 / rate);
  const double samples = std::max(1.0, std::round(machine.scene.smoother_samples * rate / 1000.0));
  if (samples > kMaxSmootherLength) {
    return wrong(setting, fmt::format("the scene's smoother takes {:.0f} samples at this rate, at "
                                      "most {} are kept",
                                      samples, kMaxSmootherLength));
  }
  machine.scene.smoother_samples = static_cast<int>(samples);
  return Status::ok();
}

Status set_torque(const Override& setting, StudyMachine& machine) {
  machine.torque = setting.value == "true";
  if (machine.torque || setting.value == "false") return Status::ok();
  return wrong(setting, "expected true or false");
}

bool starts_with(const std::string& text, std::string_view start) {
  return text.compare(0, start.size(), start) == 0;
}

}  // namespace

Result<StudySetup> study_setup(const std::string& scene, const std::string& population,
                               const std::vector<std::string>& settings) {
  const auto overrides = parse_overrides(settings);
  if (!overrides) return overrides.status();
  std::vector<Override> of_scene, of_rig, of_rest;
  for (const Override& setting : *overrides) {
    if (std::find(std::begin(kSetByTheStudy), std::end(kSetByTheStudy), setting.key) !=
        std::end(kSetByTheStudy)) {
      return wrong(setting, "a study sets this itself, for each operator or from the task");
    }
    if (starts_with(setting.key, "rig.")) {
      of_rig.push_back(setting);
    } else if (starts_with(setting.key, "operator.") || starts_with(setting.key, "haptic.") ||
               starts_with(setting.key, "link.")) {
      of_rest.push_back(setting);
    } else {
      of_scene.push_back(setting);
    }
  }

  StudySetup out;
  const auto scene_file = SceneLibrary().find(scene);
  if (!scene_file) return scene_file.status();
  pb::Scene raw;
  auto loaded = load_scene_file(*scene_file, &raw, of_scene);
  if (!loaded) return loaded.status();
  out.machine.scene = std::move(*loaded);
  out.machine.recording.scene_text = scene_file_text(raw);
  const auto rig = rig_options(of_rig);
  if (!rig) return rig.status();
  out.machine.rig = *rig;
  const auto file = find_population(population);
  if (!file) return file.status();
  auto people = load_population(*file);
  if (!people) return people.status();
  out.population = std::move(*people);

  for (const Override& setting : of_rest) {
    Status status = Status::ok();
    double delay = 0.0;
    if (starts_with(setting.key, "operator.")) {
      status = set_parameter(setting, setting.key.substr(std::string("operator.").size()),
                             out.population);
    } else if (setting.key == "haptic.rate_hz") {
      status = set_rate(setting, out.machine);
    } else if (setting.key == "haptic.torque") {
      status = set_torque(setting, out.machine);
    } else if (setting.key == "link.delay_ms") {
      status = number_in(setting, 0.0, kLongestDelay, " ms", delay);
      out.machine.transit = std::llround(delay * 1e6);
    } else {
      status = wrong(setting,
                     "no such key; expected haptic.rate_hz, haptic.torque, link.delay_ms, "
                     "operator.PARAMETER, rig.FIELD or a field of the scene");
    }
    if (!status) return status;
  }
  return out;
}

}  // namespace handrail
