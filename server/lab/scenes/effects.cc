#include "server/lab/scenes/effects.h"

#include <fmt/format.h>

#include "server/base/units.h"
#include "server/lab/scenes/explain_price.h"

namespace handrail {
namespace {

std::string figures(const PressResult& r) {
  return fmt::format(
      "\"peak_force_n\": {:.6g}, \"mean_contact_force_n\": {:.6g}, \"tip_off_mm\": {:.6g}, "
      "\"encoders_off_mm\": {:.6g}, "
      "\"sensor_off_n\": {:.6g}, \"screw_deg\": {:.6g}",
      r.peak, r.mean, r.tip_off / kMm, r.read_off / kMm, r.sensor_off, r.screw / kDeg);
}

std::string line(const std::string& name, const PressResult& r, double ns) {
  return fmt::format("  {:<24}{:>9.2f}{:>9.2f}{:>9.3f}{:>13.3f}{:>10.3f}{:>8.1f}{:>9.0f}\n", name,
                     r.peak, r.mean, r.tip_off / kMm, r.read_off / kMm, r.sensor_off,
                     r.screw / kDeg, ns);
}

}  // namespace

Result<EffectRows> effects_in_turn(const Scene& scene, const std::atomic<bool>& cancelled) {
  if (scene.walls) {
    return Status::error("scene '" + scene.name +
                         "': no arm takes part; price-check leaves effects of walls out in turn");
  }
  const Result<PressCourse> course = press_course(scene);
  if (!course) return course.status();
  const Result<RigPrice> price = price_of_rig(scene, cancelled);
  if (!price) return price.status();
  if (cancelled) return Status::error("cancelled");
  EffectRows out;
  out.scene = scene.name;
  out.whole = run_press(scene, *course);
  out.step_ns = price->step_ns;
  const std::vector<RigWithout> rigs = rigs_without_each(scene);
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    out.rows.push_back(
        {rigs[i].left_out, run_press(rigs[i].scene, *course), price->effects[i].ns_per_tick});
  }
  return out;
}

std::string effects_json(const EffectRows& rows) {
  std::string out =
      fmt::format("{{\"scene\": \"{}\", \"whole\": {{{}, \"ns_per_tick\": {:.6g}}}, \"without\": [",
                  rows.scene, figures(rows.whole), rows.step_ns);
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const EffectRow& row = rows.rows[i];
    out += fmt::format("{}{{\"effect\": \"{}\", {}, \"ns_per_tick\": {:.6g}}}", i > 0 ? ", " : "",
                       row.left_out, figures(row.result), row.ns);
  }
  return out + "]}\n";
}

std::string effects_table(const EffectRows& rows) {
  std::string out =
      fmt::format("{:<26}{:>9}{:>9}{:>9}{:>13}{:>10}{:>8}{:>9}\n", rows.scene, "peak N", "mean N",
                  "tip mm", "encoders mm", "sensor N", "screw", "ns a ms");
  out += line("all effects", rows.whole, rows.step_ns);
  out += "without, and what it costs:\n";
  for (const EffectRow& row : rows.rows) out += line(row.left_out, row.result, row.ns);
  return out +
         "A fixed course of the arm, without bumper or operator. tip: true tip from where it was "
         "led, RMS;\nencoders: tip as they read it from the true one, RMS; sensor: force read from "
         "that of contact,\nRMS; screw: degrees tightened.\n";
}

}  // namespace handrail
