// The named cases together, and how they are printed.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/lab/sequences/tool_cases.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

double ratio_of(const ToolCase& c, Bound bound) {
  return c.worst[static_cast<std::size_t>(bound)].ratio;
}

}  // namespace

std::vector<ToolCase> run_tool_cases(
    int threads, const std::atomic<bool>& cancelled,
    const std::function<void(std::size_t done, std::size_t of)>& progress) {
  constexpr std::array kAll = {tool_change_cases, turned_hand_cases, parallel_axis_cases,
                               half_turn_cases};
  std::array<std::vector<ToolCase>, kAll.size()> parts;
  const auto show = [&](std::size_t done) {
    if (progress) progress(done, kAll.size());
  };
  const bool all = run_parallel(
      kAll.size(), threads, [&](std::size_t i) { parts[i] = kAll[i](); }, show, &cancelled);
  std::vector<ToolCase> out;
  if (!all) return out;
  for (const std::vector<ToolCase>& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

std::size_t failures_of(const std::vector<ToolCase>& cases) {
  return static_cast<std::size_t>(std::count_if(
      cases.begin(), cases.end(), [](const ToolCase& c) { return !c.failure.empty(); }));
}

std::string tool_cases_table(const std::vector<ToolCase>& cases) {
  std::string out = fmt::format("  {:<70}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}\n", "share of the bound",
                                "force", "torque", "step", "turn", "drift, m", "eased, s");
  for (const ToolCase& c : cases) {
    out += fmt::format("  {:<70}{:>8.4f}{:>8.4f}{:>8.4f}{:>8.4f}{:>10.1g}{:>9.2f}{}\n", c.name,
                       ratio_of(c, Bound::kForceStep), ratio_of(c, Bound::kTorqueStep),
                       ratio_of(c, Bound::kCommandStep), ratio_of(c, Bound::kCommandTurn), c.drift,
                       c.settled, c.failure.empty() ? "" : "  " + c.failure);
  }
  return out + fmt::format("  {} cases, {} fail\n", cases.size(), failures_of(cases));
}

std::string tool_cases_json(const std::vector<ToolCase>& cases) {
  std::string out = "{\"cases\": [";
  for (const ToolCase& c : cases) {
    out += fmt::format(
        "{}\n  {{\"case\": \"{}\", \"force_step\": {}, \"torque_step\": {}, \"command_step\": {}, "
        "\"command_turn\": {}, \"drift_m\": {}, \"drift_rad\": {}, "
        "\"off_tool_m\": {}, \"energy_J\": {}, \"eased_s\": {}, \"failure\": \"{}\"}}",
        &c == cases.data() ? "" : ",", c.name, ratio_of(c, Bound::kForceStep),
        ratio_of(c, Bound::kTorqueStep), ratio_of(c, Bound::kCommandStep),
        ratio_of(c, Bound::kCommandTurn), c.drift, c.drift_angle, c.off_tool, c.energy, c.settled,
        c.failure);
  }
  return out + "\n]}\n";
}

}  // namespace handrail
