#include "client/experiment/experiment_results_io.h"

#include <algorithm>
#include <array>
#include <ctime>

#include "client/experiment/wall_results_io.h"
#include "server/lab/study/linear/linear_report_io.h"

namespace handrail {
namespace {

StudyMode mode_of(const pb::LinearTrial& trial) {
  return trial.mode() == name_of(StudyMode::kTools) ? StudyMode::kTools : StudyMode::kFree;
}

}  // namespace

pb::ExperimentTrial trial_line(const TrialNext& next) {
  pb::ExperimentTrial out;
  pb::LinearTrial& linear = *out.mutable_linear();
  linear.set_mode(name_of(static_cast<StudyMode>(next.mode)));
  linear.set_number(static_cast<std::uint32_t>(next.number));
  linear.set_attempt(static_cast<std::uint32_t>(next.attempt));
  return out;
}

void fill_ended(const TrialNext& next, const TrialResult& result, pb::ExperimentTrial& out) {
  LinearStudyTrial trial{0, static_cast<StudyMode>(next.mode), next.number, next.attempt, result};
  fill(trial, *out.mutable_linear());
}

std::vector<TrialMade> trials_made(const ExperimentRecord& record) {
  std::vector<TrialMade> out;
  for (const pb::ExperimentTrial& trial : record.trials) {
    const std::string& end = trial.has_walls() ? trial.walls().end() : trial.linear().end();
    const int mode = trial.has_walls() ? 0 : static_cast<int>(mode_of(trial.linear()));
    out.push_back({mode, trial.practice(), trial.interrupted(), end == name_of(TrialEnd::kDone)});
  }
  return out;
}

LinearStudy study_of(const std::vector<ExperimentRecord>& people) {
  LinearStudy out;
  int person = 0;
  for (const ExperimentRecord& record : people) {
    for (const pb::ExperimentTrial& trial : record.trials) {
      if (trial.practice() || trial.interrupted()) continue;
      const pb::LinearTrial& linear = trial.linear();
      out.trials.push_back({person, mode_of(linear), static_cast<int>(linear.number()),
                            static_cast<int>(linear.attempt()), result_of(linear)});
    }
    ++person;
  }
  return out;
}

StudyHeader header_of(const std::vector<ExperimentRecord>& people) {
  StudyHeader out;
  out.simulated = people.front().subject.simulated();
  out.scene = people.front().subject.experiment();
  out.population = out.simulated ? out.scene : "people";
  out.seed = kReportSeed;
  out.operators = static_cast<int>(people.size());
  for (const ExperimentRecord& record : people) {
    out.trials = std::max(out.trials, static_cast<int>(record.subject.trials()));
  }
  return out;
}

std::string results_text(const std::vector<ExperimentRecord>& people, bool json) {
  if (people.front().subject.experiment() != "linear-movement")
    return wall_results_text(people, json);
  return (json ? linear_json : linear_table)(header_of(people), study_of(people), {});
}

std::string calendar_text(Nanos since_1970) {
  const auto seconds = static_cast<std::time_t>(since_1970 / kSecond);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

}  // namespace handrail
