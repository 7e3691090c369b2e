#include "server/lab/study/screw/screw_report_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "proto/screw_study.pb.h"
#include "server/lab/study/screw/screw_figure.h"
#include "server/lab/study/screw/screw_verdict.h"
#include "server/lab/study/study_report_io.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

MeasureStats stats_in(const ScrewStudy& study, ScrewMode mode, ScrewFigure figure,
                      std::uint64_t seed) {
  return stats_of(values_of(study, mode, figure), info_of(figure).per_si, seed);
}

std::uint32_t counted(const ScrewStudy& study, ScrewMode mode, ScrewEnd end) {
  return static_cast<std::uint32_t>(study.count(mode, end));
}

void fill(const ScrewStudy& study, ScrewMode mode, std::uint64_t seed, pb::ScrewMode& out) {
  for (int i = 0; i < kScrewFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    fill(stats_in(study, mode, figure, seed), info_of(figure).implied[static_cast<int>(mode)],
         child<pb::Measure>(out, info_of(figure).name));
  }
  out.set_trials(static_cast<std::uint32_t>(study.count(mode)));
  pb::ScrewFailures& failures = *out.mutable_failures();
  failures.set_force(counted(study, mode, ScrewEnd::kForce));
  failures.set_key_lost(counted(study, mode, ScrewEnd::kKeyLost));
  failures.set_timed_out(counted(study, mode, ScrewEnd::kTimeOut));
  failures.set_session_lost(counted(study, mode, ScrewEnd::kSession));
  out.set_worst_force_n(worst_force(study, mode));
}

void fill(const ScrewStudy& study, ScrewPairing pairing, std::uint64_t seed,
          pb::ScrewComparison& out) {
  for (int i = 0; i < kComparedFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    fill(comparison_of(study, pairing, figure, seed),
         child<pb::Comparison>(out, info_of(figure).name));
  }
  const FailureComparison failed = failures_of(study, pairing);
  pb::FailureComparison& failures = *out.mutable_failures();
  failures.set_without(static_cast<std::uint32_t>(failed.without));
  failures.set_with(static_cast<std::uint32_t>(failed.with));
  failures.set_no_more(failed.no_more.value);
  fill(failed.no_more.value_95, *failures.mutable_no_more_95());
}

// Modes and comparisons, of the study or of a variation.
template <typename Proto>
void fill_results(const ScrewStudy& study, std::uint64_t seed, Proto& out) {
  pb::ScrewModes& modes = *out.mutable_modes();
  fill(study, ScrewMode::kNCNV, seed, *modes.mutable_nc_nv());
  fill(study, ScrewMode::kNCV, seed, *modes.mutable_nc_v());
  fill(study, ScrewMode::kCNV, seed, *modes.mutable_c_nv());
  fill(study, ScrewMode::kCV, seed, *modes.mutable_c_v());
  fill(study, ScrewPairing::kToolsNC, seed, *out.mutable_tools_help()->mutable_nc());
  fill(study, ScrewPairing::kToolsC, seed, *out.mutable_tools_help()->mutable_c());
  fill(study, ScrewPairing::kProtectionNV, seed, *out.mutable_protection_helps()->mutable_nv());
  fill(study, ScrewPairing::kProtectionV, seed, *out.mutable_protection_helps()->mutable_v());
}

// Modes are keyed by their names, which cannot be names of fields.
std::string with_mode_names(std::string json) {
  for (int i = 0; i < kScrewModes; ++i) {
    const std::string name = fmt::format("\"{}\": {{", name_of(static_cast<ScrewMode>(i)));
    std::string field = name;
    std::replace(field.begin(), field.end(), '-', '_');
    for (std::size_t at = 0; (at = json.find(field, at)) != std::string::npos;) {
      json.replace(at, field.size(), name);
    }
  }
  return json;
}

std::string measures_table(const ScrewStudy& study, std::uint64_t seed) {
  std::string out = measures_heading("implied");
  for (int i = 0; i < kScrewFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    const ScrewFigureInfo& info = info_of(figure);
    for (int k = 0; k < kScrewModes; ++k) {
      const auto mode = static_cast<ScrewMode>(k);
      out += measure_row(k == 0 ? fmt::format("{} [{}]", info.title, info.unit) : "", name_of(mode),
                         stats_in(study, mode, figure, seed), info.implied[k]);
    }
  }
  return out;
}

std::string comparison_table(const ScrewStudy& study, std::uint64_t seed) {
  constexpr const char* kTitles[kScrewPairs] = {
      "with tools, without protection", "with tools, with protection",
      "with protection, without tools", "with protection, with tools"};
  std::string out;
  for (int i = 0; i < kScrewPairs; ++i) {
    const auto pairing = static_cast<ScrewPairing>(i);
    const ScrewPair pair = pair_of(pairing);
    out += comparison_heading(
        kTitles[i], fmt::format("{} / {}", name_of(pair.with), name_of(pair.without)), "implied");
    for (int k = 0; k < kComparedFigures; ++k) {
      const auto figure = static_cast<ScrewFigure>(k);
      out += comparison_row(info_of(figure).title, comparison_of(study, pairing, figure, seed),
                            implied_ratio(pairing, figure));
    }
    const FailureComparison failed = failures_of(study, pairing);
    out += fmt::format("{:38}{:>12}  {:>16}{:>16.0f} %  {:>14}\n", "failed trials; no more of them",
                       fmt::format("{} / {}", failed.with, failed.without), "",
                       100.0 * failed.no_more.value,
                       text_of(failed.no_more.value_95, 100.0, "{:.0f} to {:.0f} %"));
  }
  return out;
}

std::string failures_table(const ScrewStudy& study) {
  std::string out =
      "\nfailed trials (the worst rank in time, path, impulse and contact time; their forces "
      "count)\n";
  for (int i = 0; i < kScrewModes; ++i) {
    const auto mode = static_cast<ScrewMode>(i);
    out += fmt::format(
        "{:6} {} of {} ({} over 500 N, {} key lost, {} timed out, {} session lost); hardest trial "
        "{:.0f} N\n",
        name_of(mode), study.failures(mode), study.count(mode), study.count(mode, ScrewEnd::kForce),
        study.count(mode, ScrewEnd::kKeyLost), study.count(mode, ScrewEnd::kTimeOut),
        study.count(mode, ScrewEnd::kSession), worst_force(study, mode));
  }
  return out;
}

std::string variation_row(const std::string& setting, const ScrewStudy& study, ScrewMode mode) {
  std::string out = fmt::format("{:40}", setting);
  for (int i = 0; i < kComparedFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    out += fmt::format("{:11.3g}",
                       median(pooled(values_of(study, mode, figure))) * info_of(figure).per_si);
  }
  return out + fmt::format("{:13.3g}{:8}\n", worst_force(study, mode), study.failures(mode));
}

std::string variations_table(const ScrewStudy& study, const std::vector<ScrewVariation>& variations,
                             std::uint64_t seed) {
  std::string out;
  for (int i = 0; i < kScrewModes; ++i) {
    const auto mode = static_cast<ScrewMode>(i);
    out += fmt::format("\n{:40}{:>11}{:>11}{:>11}{:>11}{:>13}{:>8}\n",
                       fmt::format("medians side by side, {}", name_of(mode)), "time, s",
                       "path, mm", "mean, N", "max, N", "hardest, N", "failed");
    out += variation_row("as the scene and population say", study, mode);
    for (const ScrewVariation& variation : variations) {
      out += variation_row(variation.setting, variation.result, mode);
    }
  }
  for (const ScrewVariation& variation : variations) {
    out += same_people_table<ScrewFigure, ScrewMode>(variation.setting, variation.result, study,
                                                     kScrewModes, kComparedFigures, seed);
  }
  return out;
}

std::string heading(const StudyHeader& header, BumperSettings::Form bumper) {
  const std::string modes = fmt::format(
      "NC without bumper and virtual spring, C with them ({} bumper); NV without tools, V "
      "with\nthem.",
      name_of(bumper));
  constexpr const char* kImplied = "Implied: by the dissertation's savings, 7 people.\n\n";
  if (!header.simulated) {
    return fmt::format(
        "Screw fastening: {} people, {} successful trials each and mode wanted, scene {},\nat a "
        "simulated arm. {} {}",
        header.operators, header.trials, header.scene, modes, kImplied);
  }
  return fmt::format(
      "Screw fastening: {} simulated operators, {} successful trials each and mode, seed {}, scene "
      "{},\npopulation {}. {} The population was fitted to NC-NV alone. {}",
      header.operators, header.trials, header.seed, header.scene, header.population, modes,
      kImplied);
}

std::string verdict(const StudyHeader& header, const ScrewStudy& study) {
  const std::uint64_t seed = header.seed;
  const std::vector<ScrewEffect> effects = effects_of(study, seed);
  const auto same = std::count_if(effects.begin(), effects.end(),
                                  [](const ScrewEffect& effect) { return effect.reproduced(); });
  std::string out =
      fmt::format("\nOf {} sizes in the dissertation {} {}:\n", effects.size(),
                  header.simulated ? "the model reproduces" : "these people show", same);
  for (const ScrewEffect& effect : effects) out += "  " + text_of(effect) + '\n';
  out += fmt::format("\n{:90}{:>22}\n", "targets", "found");
  for (const ScrewTarget& target : targets_of(study, seed)) {
    out +=
        fmt::format("{:90}{:>22}  {}\n", target.what, target.found, target.met ? "met" : "NOT met");
  }
  return out;
}

}  // namespace

void fill(const ScrewStudyTrial& trial, pb::ScrewTrial& out) {
  fill_trial(trial, out);
  for (int i = 0; i < kScrewFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    set_number(out, info_of(figure).name,
               measured_of(trial.result, figure) * info_of(figure).per_si);
  }
  out.set_misses(static_cast<std::uint32_t>(trial.result.misses));
}

ScrewResult result_of(const pb::ScrewTrial& trial) {
  ScrewResult out;
  for (int i = 0; i < kScrewEnds; ++i) {
    if (trial.end() == name_of(static_cast<ScrewEnd>(i))) out.end = static_cast<ScrewEnd>(i);
  }
  for (int i = 0; i < kScrewFigures; ++i) {
    const ScrewFigureInfo& info = info_of(static_cast<ScrewFigure>(i));
    value_in(out, static_cast<ScrewFigure>(i)) = number_of(trial, info.name) / info.per_si;
  }
  out.misses = static_cast<int>(trial.misses());
  return out;
}

const char* name_of(BumperSettings::Form form) noexcept {
  return form == BumperSettings::Form::kPublished ? "published" : "default";
}

std::string screw_json(const StudyHeader& header, BumperSettings::Form bumper,
                       const ScrewStudy& study, const std::vector<ScrewVariation>& variations) {
  pb::ScrewStudy out;
  fill(header, "screw-fastening", out);
  out.set_bumper(name_of(bumper));
  fill_results(study, header.seed, out);
  for (const ScrewVariation& variation : variations) {
    pb::ScrewVariation& varied = *out.add_variations();
    varied.set_setting(variation.setting);
    fill_results(variation.result, header.seed, varied);
  }
  for (const ScrewStudyTrial& trial : study.trials) fill(trial, *out.add_trials());
  return with_mode_names(json_of_set_fields(out, true)) + '\n';
}

std::string screw_table(const StudyHeader& header, BumperSettings::Form bumper,
                        const ScrewStudy& study, const std::vector<ScrewVariation>& variations) {
  std::string out = heading(header, bumper);
  out += measures_table(study, header.seed) + comparison_table(study, header.seed) +
         failures_table(study);
  if (!variations.empty()) out += variations_table(study, variations, header.seed);
  return out + verdict(header, study);
}

}  // namespace handrail
