#include "server/lab/study/linear_report_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "proto/study.pb.h"
#include "server/lab/study/linear_figure.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

constexpr std::size_t kCohort = 7;  // people in the dissertation's study

// Everything said of one measure of one mode, in the measure's unit.
struct MeasureStats {
  Summary summary;
  Interval median_95;
  Interval cohort_95;
};

// Every call starts from the same seed, so that no number depends on which others are printed.
MeasureStats stats_of(const StudyResult& study, StudyMode mode, LinearFigure figure,
                      std::uint64_t seed) {
  ByPerson values = values_of(study, mode, figure);
  const double factor = info_of(figure).per_si;
  for (auto& person : values) {
    for (double& value : person) value *= factor;
  }
  Random bootstrap(seed), cohorts(seed + 1);
  return {summarise(pooled(values)), bootstrap_median(values, bootstrap),
          cohort_spread(values, kCohort, cohorts)};
}

Paired comparison_of(const StudyResult& study, LinearFigure figure, std::uint64_t seed) {
  Random random(seed + 2);
  return compare_paired(values_of(study, StudyMode::kTools, figure),
                        values_of(study, StudyMode::kFree, figure), random);
}

int ended(const StudyResult& study, StudyMode mode, TrialEnd end) {
  return static_cast<int>(std::count_if(
      study.trials.begin(), study.trials.end(),
      [&](const StudyTrial& trial) { return trial.mode == mode && trial.result.end == end; }));
}

int trials_in(const StudyResult& study, StudyMode mode) {
  return static_cast<int>(
      std::count_if(study.trials.begin(), study.trials.end(),
                    [&](const StudyTrial& trial) { return trial.mode == mode; }));
}

void fill(const Interval& interval, pb::Interval& out) {
  out.set_low(interval.low);
  out.set_high(interval.high);
}

void fill(const MeasureStats& stats, double published, pb::Measure& out) {
  out.set_min(stats.summary.min);
  out.set_q1(stats.summary.q1);
  out.set_median(stats.summary.median);
  out.set_q3(stats.summary.q3);
  out.set_max(stats.summary.max);
  out.set_mean(stats.summary.mean);
  fill(stats.median_95, *out.mutable_median_95());
  fill(stats.cohort_95, *out.mutable_cohort_95());
  if (published > 0.0) out.set_published(published);
}

// The sub-message of a measure, by its name in the .proto.
template <typename Child, typename Parent>
Child& child(Parent& parent, LinearFigure figure) {
  const auto* field = parent.GetDescriptor()->FindFieldByName(info_of(figure).name);
  return static_cast<Child&>(*parent.GetReflection()->MutableMessage(&parent, field));
}

void fill(const StudyResult& study, std::uint64_t seed, pb::LinearModes& modes,
          pb::LinearComparison& comparison) {
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    pb::LinearMode& out = mode == StudyMode::kFree ? *modes.mutable_nv() : *modes.mutable_v();
    for (int i = 0; i < kLinearFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      fill(stats_of(study, mode, figure, seed), info_of(figure).published[static_cast<int>(mode)],
           child<pb::Measure>(out, figure));
    }
    out.set_trials(static_cast<std::uint32_t>(trials_in(study, mode)));
    out.set_timed_out(static_cast<std::uint32_t>(ended(study, mode, TrialEnd::kTimeOut)));
    out.set_off_target(static_cast<std::uint32_t>(ended(study, mode, TrialEnd::kOffTarget)));
    out.set_session_lost(static_cast<std::uint32_t>(ended(study, mode, TrialEnd::kSession)));
  }
  for (int i = 0; i < kPublishedFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    const Paired paired = comparison_of(study, figure, seed);
    auto& out = child<pb::Comparison>(comparison, figure);
    out.set_ratio(paired.ratio);
    fill(paired.ratio_95, *out.mutable_ratio_95());
    out.set_helped(paired.helped);
    fill(paired.helped_95, *out.mutable_helped_95());
  }
}

void fill(const StudyTrial& trial, pb::LinearTrial& out) {
  out.set_person(static_cast<std::uint32_t>(trial.person));
  out.set_mode(name_of(trial.mode));
  out.set_number(static_cast<std::uint32_t>(trial.number));
  out.set_attempt(static_cast<std::uint32_t>(trial.attempt));
  out.set_end(name_of(trial.result.end));
  // What a failed trial did is told too; it just does not count.
  TrialResult measured = trial.result;
  measured.end = TrialEnd::kDone;
  for (int i = 0; i < kLinearFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    const auto* field = out.GetDescriptor()->FindFieldByName(info_of(figure).name);
    out.GetReflection()->SetDouble(&out, field,
                                   value_of(measured, figure) * info_of(figure).per_si);
  }
}

std::string numbers(const MeasureStats& s) {
  return fmt::format("{:8.3g}{:8.3g}{:9.3g}{:8.3g}{:8.3g}{:8.3g}  {:>15}  {:>15}", s.summary.min,
                     s.summary.q1, s.summary.median, s.summary.q3, s.summary.max, s.summary.mean,
                     fmt::format("{:.3g} to {:.3g}", s.median_95.low, s.median_95.high),
                     fmt::format("{:.3g} to {:.3g}", s.cohort_95.low, s.cohort_95.high));
}

std::string measures_table(const StudyResult& study, std::uint64_t seed) {
  std::string out =
      fmt::format("{:40}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}  {:>15}  {:>15}{:>11}\n", "", "min", "q1",
                  "median", "q3", "max", "mean", "median, 95 %", "cohorts of 7", "published");
  for (int i = 0; i < kLinearFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
      const std::string label = fmt::format("{} [{}]", info_of(figure).title, info_of(figure).unit);
      const double published = info_of(figure).published[static_cast<int>(mode)];
      out += fmt::format("{:36}{:<4}{}{:>11}\n", mode == StudyMode::kFree ? label : "",
                         name_of(mode), numbers(stats_of(study, mode, figure, seed)),
                         published > 0.0 ? fmt::format("{:.4g}", published) : "");
    }
  }
  return out;
}

std::string comparison_table(const StudyResult& study, std::uint64_t seed) {
  std::string out = fmt::format("\n{:40}{:>10}  {:>16}{:>18}  {:>14}\n", "with tools", "V / NV",
                                "95 %", "operators helped", "95 %");
  for (int i = 0; i < kPublishedFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    const Paired p = comparison_of(study, figure, seed);
    out += fmt::format(
        "{:40}{:>10.3f}  {:>16}{:>16.0f} %  {:>14}\n", info_of(figure).title, p.ratio,
        fmt::format("{:.3f} to {:.3f}", p.ratio_95.low, p.ratio_95.high), 100.0 * p.helped,
        fmt::format("{:.0f} to {:.0f} %", 100.0 * p.helped_95.low, 100.0 * p.helped_95.high));
  }
  return out;
}

std::string failures_line(const StudyResult& study) {
  std::string out = "\nfailed trials (the worst rank in every median): ";
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const int timed_out = ended(study, mode, TrialEnd::kTimeOut);
    const int off = ended(study, mode, TrialEnd::kOffTarget);
    const int lost = ended(study, mode, TrialEnd::kSession);
    out += fmt::format("{} {} of {} ({} timed out, {} off target, {} session lost)", name_of(mode),
                       timed_out + off + lost, trials_in(study, mode), timed_out, off, lost);
    out += mode == StudyMode::kFree ? "; " : "\n";
  }
  return out;
}

std::string variation_row(const std::string& setting, const StudyResult& study) {
  std::string out = fmt::format("{:40}", setting);
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    for (int i = 0; i < kPublishedFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      out += fmt::format("{:9.3g}",
                         median(pooled(values_of(study, mode, figure))) * info_of(figure).per_si);
    }
    out += fmt::format("{:7}", trials_in(study, mode) - ended(study, mode, TrialEnd::kDone));
  }
  return out + '\n';
}

std::string variations_table(const StudyResult& study,
                             const std::vector<StudyVariation>& variations) {
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
  for (const StudyVariation& variation : variations) {
    out += variation_row(variation.setting, variation.result);
  }
  return out;
}

}  // namespace

std::string linear_json(const StudyHeader& header, const StudyResult& study,
                        const std::vector<StudyVariation>& variations) {
  pb::LinearStudy out;
  out.set_experiment("linear-movement");
  out.set_simulated(true);
  out.set_seed(header.seed);
  out.set_operators(static_cast<std::uint32_t>(header.operators));
  out.set_trials_per_mode(static_cast<std::uint32_t>(header.trials));
  out.set_population(header.population);
  out.set_scene(header.scene);
  fill(study, header.seed, *out.mutable_modes(), *out.mutable_tools_help());
  for (const StudyVariation& variation : variations) {
    pb::LinearVariation& varied = *out.add_variations();
    varied.set_setting(variation.setting);
    fill(variation.result, header.seed, *varied.mutable_modes(), *varied.mutable_tools_help());
  }
  for (const StudyTrial& trial : study.trials) fill(trial, *out.add_trials());
  return json_of_set_fields(out, true) + '\n';
}

std::string linear_table(const StudyHeader& header, const StudyResult& study,
                         const std::vector<StudyVariation>& variations) {
  std::string out = fmt::format(
      "Linear movement with fixed orientation: {} simulated operators, {} successful trials each "
      "and mode,\nseed {}, scene {}, population {}. NV without tools, V with them; the population "
      "was fitted to the\npublished NV medians alone. Published: 7 people.\n\n",
      header.operators, header.trials, header.seed, header.scene, header.population);
  out += measures_table(study, header.seed) + comparison_table(study, header.seed) +
         failures_line(study);
  if (!variations.empty()) out += variations_table(study, variations);
  return out;
}

}  // namespace handrail
