#include "server/lab/scenes/report_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>

#include "proto/accuracy.pb.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

std::string memory_text(std::size_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 1e4) return fmt::format("{:.0f} B", size);
  return size < 1e7 ? fmt::format("{:.0f} kB", size * 1e-3) : fmt::format("{:.1f} MB", size * 1e-6);
}

void fill(const AccuracyRow::Error& error, pb::AccuracyError& out) {
  out.set_unit(error.unit);
  out.set_rms(error.rms);
  out.set_worst(error.worst);
}

}  // namespace

std::string accuracy_json(const AccuracyRows& rows) {
  pb::AccuracyTable table;
  const std::vector<bool> best = efficient(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const AccuracyRow& row = rows[i];
    pb::AccuracyRow& out = *table.add_rows();
    out.set_choice(row.choice);
    out.set_method(row.method);
    out.set_setting(row.setting);
    fill(row.error, *out.mutable_error());
    if (!row.whole.unit.empty()) fill(row.whole, *out.mutable_whole_error());
    out.mutable_cost()->set_unit(row.cost.unit);
    out.mutable_cost()->set_median(row.cost.median);
    out.mutable_cost()->set_p999(row.cost.p999);
    out.set_memory_bytes(static_cast<std::uint32_t>(row.memory_bytes));
    out.set_efficient(best[i]);
    if (!row.note.empty()) out.set_note(row.note);
  }
  return json_of_set_fields(table, true) + "\n";
}

std::string accuracy_table(const AccuracyRows& rows) {
  std::string out;
  const std::vector<bool> best = efficient(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const AccuracyRow& row = rows[i];
    if (i == 0 || rows[i - 1].choice != row.choice) {
      const std::string error = fmt::format("error [{}]", row.error.unit);
      const std::string cost = fmt::format("cost [{}]", row.cost.unit);
      out += fmt::format("{}{:<48}{:>12}{:>11}{:>14}{:>11}{:>10}\n", i == 0 ? "" : "\n", row.choice,
                         error, "worst", cost, "99.9 %", "memory");
    }
    out += fmt::format("{} {:<18}{:<28}{:>12.3g}{:>11.3g}{:>14.4g}{:>11.4g}{:>10}{}\n",
                       best[i] ? '*' : ' ', row.method, row.setting, row.error.rms, row.error.worst,
                       row.cost.median, row.cost.p999, memory_text(row.memory_bytes),
                       row.note.empty() ? "" : "  " + row.note);
  }
  out += "* efficient: no other setting has both less RMS error and less cost\n";
  const bool two = std::any_of(rows.begin(), rows.end(),
                               [](const AccuracyRow& row) { return !row.whole.unit.empty(); });
  if (two) {
    out +=
        "wall: the error is from the true surface; 'handrail scene resolve' goes by the one from "
        "the exact proxy,\nwhich counts what the proxy stays behind along the wall, too\n";
  }
  return out;
}

std::string explanation_json(const Explanation& explanation) {
  pb::SceneExplanation out;
  out.set_scene(explanation.scene);
  for (const PricedEffect& effect : explanation.effects) {
    pb::ExplainedEffect& e = *out.add_effects();
    e.set_name(effect.name);
    e.set_side(effect.on_rig ? "rig" : "master");
    e.set_ns_per_tick(effect.ns_per_tick);
  }
  for (const std::string& name : explanation.not_simulated) out.add_not_simulated(name);
  return json_text(out, true) + "\n";
}

std::string explanation_table(const Explanation& explanation) {
  std::string out = fmt::format("{:<28}{:<10}{:>12}\n", explanation.scene, "side", "ns a tick");
  for (const PricedEffect& effect : explanation.effects) {
    out += fmt::format("  {:<26}{:<10}{:>12.1f}\n", effect.name, effect.on_rig ? "rig" : "master",
                       effect.ns_per_tick);
  }
  out += "not simulated:\n";
  for (const std::string& name : explanation.not_simulated) out += "  " + name + "\n";
  return out;
}

}  // namespace handrail
