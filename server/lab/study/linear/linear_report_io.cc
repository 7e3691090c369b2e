#include "server/lab/study/linear/linear_report_io.h"

#include <spdlog/fmt/fmt.h>

#include "proto/study.pb.h"
#include "server/lab/study/linear/linear_figure.h"
#include "server/lab/study/study_report_io.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

MeasureStats stats_in(const LinearStudy& study, StudyMode mode, LinearFigure figure,
                      std::uint64_t seed) {
  return stats_of(values_of(study, mode, figure), info_of(figure).per_si, seed);
}

Paired comparison_of(const LinearStudy& study, LinearFigure figure, std::uint64_t seed) {
  Random random(seed + 2);
  return compare_paired(values_of(study, StudyMode::kTools, figure),
                        values_of(study, StudyMode::kFree, figure), random);
}

void fill(const LinearStudy& study, std::uint64_t seed, pb::LinearModes& modes,
          pb::LinearComparison& comparison) {
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    pb::LinearMode& out = mode == StudyMode::kFree ? *modes.mutable_nv() : *modes.mutable_v();
    for (int i = 0; i < kLinearFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      fill(stats_in(study, mode, figure, seed), info_of(figure).published[static_cast<int>(mode)],
           child<pb::Measure>(out, info_of(figure).name));
    }
    const auto ended = [&](TrialEnd end) {
      return static_cast<std::uint32_t>(study.count(mode, end));
    };
    out.set_trials(static_cast<std::uint32_t>(study.count(mode)));
    out.set_timed_out(ended(TrialEnd::kTimeOut));
    out.set_off_target(ended(TrialEnd::kOffTarget));
    out.set_session_lost(ended(TrialEnd::kSession));
  }
  for (int i = 0; i < kPublishedFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    fill(comparison_of(study, figure, seed),
         child<pb::Comparison>(comparison, info_of(figure).name));
  }
}

std::string measures_table(const LinearStudy& study, std::uint64_t seed) {
  std::string out = measures_heading("published");
  for (int i = 0; i < kLinearFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    const LinearFigureInfo& info = info_of(figure);
    for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
      const std::string label = fmt::format("{} [{}]", info.title, info.unit);
      out +=
          measure_row(mode == StudyMode::kFree ? label : "", name_of(mode),
                      stats_in(study, mode, figure, seed), info.published[static_cast<int>(mode)]);
    }
  }
  return out;
}

std::string comparison_table(const LinearStudy& study, std::uint64_t seed) {
  std::string out = comparison_heading("with tools", "V / NV");
  for (int i = 0; i < kPublishedFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    out += comparison_row(info_of(figure).title, comparison_of(study, figure, seed));
  }
  return out;
}

std::string failures_line(const LinearStudy& study) {
  std::string out = "\nfailed trials (the worst rank in every median): ";
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    out +=
        fmt::format("{} {} of {} ({} timed out, {} off target, {} session lost)", name_of(mode),
                    study.failures(mode), study.count(mode), study.count(mode, TrialEnd::kTimeOut),
                    study.count(mode, TrialEnd::kOffTarget), study.count(mode, TrialEnd::kSession));
    out += mode == StudyMode::kFree ? "; " : "\n";
  }
  return out;
}

std::string variation_row(const std::string& setting, const LinearStudy& study) {
  std::string out = fmt::format("{:40}", setting);
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    for (int i = 0; i < kPublishedFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      out += fmt::format("{:9.3g}",
                         median(pooled(values_of(study, mode, figure))) * info_of(figure).per_si);
    }
    out += fmt::format("{:7}", study.failures(mode));
  }
  return out + '\n';
}

std::string variations_table(const LinearStudy& study,
                             const std::vector<LinearVariation>& variations, std::uint64_t seed) {
  std::string out = fmt::format("\n{:40}", "medians side by side");
  std::string units = fmt::format("{:40}", "");
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const char* short_titles[] = {"time", "path", "pos.", "orient."};
    for (int i = 0; i < kPublishedFigures; ++i) {
      out += fmt::format("{:>9}", i == 0 ? std::string(name_of(mode)) + " " + short_titles[i]
                                         : std::string(short_titles[i]));
      units += fmt::format("{:>9}", info_of(static_cast<LinearFigure>(i)).unit);
    }
    out += fmt::format("{:>7}", "failed");
    units += fmt::format("{:>7}", "");
  }
  out += '\n' + units + '\n' + variation_row("as the scene and population say", study);
  for (const LinearVariation& variation : variations) {
    out += variation_row(variation.setting, variation.result);
  }
  for (const LinearVariation& variation : variations) {
    out += same_people_table<LinearFigure, StudyMode>(variation.setting, variation.result, study,
                                                      kStudyModes, kPublishedFigures, seed);
  }
  return out;
}

std::string heading(const StudyHeader& header) {
  if (!header.simulated) {
    return fmt::format(
        "Linear movement with fixed orientation: {} {}, {} successful trials wanted each and mode, "
        "scene {}.\nNV without tools, V with them. Published: 7 people.\n\n",
        header.operators, header.operators == 1 ? "person" : "people", header.trials, header.scene);
  }
  return fmt::format(
      "Linear movement with fixed orientation: {} simulated operators, {} successful trials each "
      "and mode,\nseed {}, scene {}, population {}. NV without tools, V with them; the population "
      "was fitted to the\npublished NV medians alone. Published: 7 people.\n\n",
      header.operators, header.trials, header.seed, header.scene, header.population);
}

}  // namespace

void fill(const LinearStudyTrial& trial, pb::LinearTrial& out) {
  fill_trial(trial, out);
  // What a failed trial did is told too; it just does not count.
  TrialResult measured = trial.result;
  measured.end = TrialEnd::kDone;
  for (int i = 0; i < kLinearFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    set_number(out, info_of(figure).name, value_of(measured, figure) * info_of(figure).per_si);
  }
}

TrialResult result_of(const pb::LinearTrial& trial) {
  TrialResult out;
  for (int i = 0; i < kTrialEnds; ++i) {
    if (trial.end() == name_of(static_cast<TrialEnd>(i))) out.end = static_cast<TrialEnd>(i);
  }
  for (int i = 0; i < kLinearFigures; ++i) {
    const LinearFigureInfo& info = info_of(static_cast<LinearFigure>(i));
    out.*field_of(static_cast<LinearFigure>(i)) = number_of(trial, info.name) / info.per_si;
  }
  return out;
}

std::string linear_json(const StudyHeader& header, const LinearStudy& study,
                        const std::vector<LinearVariation>& variations) {
  pb::LinearStudy out;
  fill(header, "linear-movement", out);
  fill(study, header.seed, *out.mutable_modes(), *out.mutable_tools_help());
  for (const LinearVariation& variation : variations) {
    pb::LinearVariation& varied = *out.add_variations();
    varied.set_setting(variation.setting);
    fill(variation.result, header.seed, *varied.mutable_modes(), *varied.mutable_tools_help());
  }
  for (const LinearStudyTrial& trial : study.trials) fill(trial, *out.add_trials());
  return json_of_set_fields(out, true) + '\n';
}

std::string linear_table(const StudyHeader& header, const LinearStudy& study,
                         const std::vector<LinearVariation>& variations) {
  std::string out = heading(header);
  out += measures_table(study, header.seed) + comparison_table(study, header.seed) +
         failures_line(study);
  if (!variations.empty()) out += variations_table(study, variations, header.seed);
  return out;
}

}  // namespace handrail
