// What the reports of all studies share: statistics of a measure, as JSON (proto/study.proto) and
// as rows of a table.
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <string>
#include <vector>

#include "server/lab/study/statistics.h"
#include "server/lab/study/study_run.h"

namespace handrail {

namespace pb {
class Comparison;
class Interval;
class Measure;
}  // namespace pb

// Everything said of one measure of one mode, in the measure's unit.
struct MeasureStats {
  Summary summary;
  Interval median_95;
  Interval cohort_95;
};

// Of values [SI]. Every call starts from the same seed, so that no number depends on which others
// are printed.
MeasureStats stats_of(ByPerson values, double per_si, std::uint64_t seed);

void fill(const Interval& interval, pb::Interval& out);
void fill(const MeasureStats& stats, double published, pb::Measure& out);  // 0: none published
void fill(const Paired& paired, pb::Comparison& out);

// The sub-message or the number of that name in the .proto.
template <typename Child, typename Parent>
Child& child(Parent& parent, const char* name) {
  const auto* field = parent.GetDescriptor()->FindFieldByName(name);
  return static_cast<Child&>(*parent.GetReflection()->MutableMessage(&parent, field));
}
inline void set_number(google::protobuf::Message& parent, const char* name, double value) {
  parent.GetReflection()->SetDouble(&parent, parent.GetDescriptor()->FindFieldByName(name), value);
}
inline double number_of(const google::protobuf::Message& parent, const char* name) {
  return parent.GetReflection()->GetDouble(parent, parent.GetDescriptor()->FindFieldByName(name));
}

template <typename Proto>
void fill(const StudyHeader& header, const char* experiment, Proto& out) {
  out.set_experiment(experiment);
  out.set_simulated(header.simulated);
  out.set_seed(header.seed);
  out.set_operators(static_cast<std::uint32_t>(header.operators));
  out.set_trials_per_mode(static_cast<std::uint32_t>(header.trials));
  out.set_population(header.population);
  out.set_scene(header.scene);
}

// What all trials say of themselves, but how they ended.
template <typename Trial, typename Proto>
void fill_trial(const Trial& trial, Proto& out) {
  out.set_person(static_cast<std::uint32_t>(trial.person));
  out.set_mode(name_of(trial.mode));
  out.set_number(static_cast<std::uint32_t>(trial.number));
  out.set_attempt(static_cast<std::uint32_t>(trial.attempt));
  out.set_end(name_of(trial.result.end));
}

// Rows of the table of measures: its heading, and a mode's; `published` as in fill().
std::string measures_heading(const std::string& published);
std::string measure_row(const std::string& label, const char* mode, const MeasureStats& stats,
                        double published);

// Rows of the table of comparisons; `expected` is the ratio published, 0 if none is.
std::string comparison_heading(const std::string& title, const std::string& ratio,
                               const std::string& expected = "");
std::string comparison_row(const std::string& title, const Paired& paired, double expected = 0.0);

// A variation beside the study as it is, the same people in both: of each mode and of the first
// `figures` measures how large with it against without.
template <typename Figure, typename Mode, typename Study>
std::string same_people_table(const std::string& setting, const Study& varied, const Study& study,
                              int modes, int figures, std::uint64_t seed) {
  std::string out = comparison_heading("the same people", setting);
  for (int m = 0; m < modes; ++m) {
    for (int i = 0; i < figures; ++i) {
      const auto mode = static_cast<Mode>(m);
      const auto figure = static_cast<Figure>(i);
      Random random(seed);
      out += comparison_row(
          std::string(name_of(mode)) + " " + info_of(figure).title,
          compare_paired(values_of(varied, mode, figure), values_of(study, mode, figure), random));
    }
  }
  return out;
}

// Both ends times `scale`, by a format such as "{:.3g} to {:.3g}".
std::string text_of(const Interval& interval, double scale, const char* format);

}  // namespace handrail
