#include "client/experiment/experiment_results_io.h"

#include <algorithm>
#include <array>
#include <ctime>

#include "client/experiment/wall_results_io.h"
#include "server/lab/study/linear/linear_report_io.h"
#include "server/lab/study/screw/screw_report_io.h"

namespace handrail {
namespace {

StudyMode mode_of(const pb::LinearTrial& trial) {
  return trial.mode() == name_of(StudyMode::kTools) ? StudyMode::kTools : StudyMode::kFree;
}

ScrewMode mode_of(const pb::ScrewTrial& trial) {
  auto out = ScrewMode::kNCNV;
  for (int i = 0; i < kScrewModes; ++i) {
    if (trial.mode() == name_of(static_cast<ScrewMode>(i))) out = static_cast<ScrewMode>(i);
  }
  return out;
}

// The trials that count, as `take` makes them of a record's and a person's number.
template <typename Study, typename Take>
Study study_from(const std::vector<ExperimentRecord>& people, const Take& take) {
  Study out;
  int person = 0;
  for (const ExperimentRecord& record : people) {
    for (const pb::ExperimentTrial& trial : record.trials) {
      if (!trial.practice() && !trial.interrupted()) out.trials.push_back(take(trial, person));
    }
    ++person;
  }
  return out;
}

TrialMade made_of(const pb::ExperimentTrial& trial) {
  TrialMade out{0, trial.practice(), trial.interrupted(), false};
  std::string end = trial.linear().end();
  if (trial.has_walls()) {
    end = trial.walls().end();
  } else if (trial.has_screw()) {
    end = trial.screw().end();
    out.mode = static_cast<int>(mode_of(trial.screw()));
  } else {
    out.mode = static_cast<int>(mode_of(trial.linear()));
  }
  out.done = end == name_of(TrialEnd::kDone);
  return out;
}

}  // namespace

pb::ExperimentTrial screw_line(const TrialNext& next) {
  pb::ExperimentTrial out;
  pb::ScrewTrial& screw = *out.mutable_screw();
  screw.set_mode(name_of(static_cast<ScrewMode>(next.mode)));
  screw.set_number(static_cast<std::uint32_t>(next.number));
  screw.set_attempt(static_cast<std::uint32_t>(next.attempt));
  return out;
}

void fill_ended(const TrialNext& next, const ScrewResult& result, pb::ExperimentTrial& out) {
  fill(ScrewStudyTrial{0, static_cast<ScrewMode>(next.mode), next.number, next.attempt, result},
       *out.mutable_screw());
}

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

std::string trial_mark(const std::string& what, const ExperimentRecord& person,
                       const std::string& mode, const std::string& how) {
  const pb::ExperimentSubject& who = person.subject;
  std::string out = "trial " + what + ": " + who.experiment() + " " + mode + " " + who.subject() +
                    " " + std::to_string(person.trials.size() + 1);
  if (who.simulated()) out += " simulated";
  return how.empty() ? out : out + " " + how;
}

std::string end_of(const pb::ExperimentTrial& trial) {
  return trial.has_linear()  ? trial.linear().end()
         : trial.has_screw() ? trial.screw().end()
                             : trial.walls().end();
}

std::vector<TrialMade> trials_made(const ExperimentRecord& record) {
  std::vector<TrialMade> out;
  for (const pb::ExperimentTrial& trial : record.trials) out.push_back(made_of(trial));
  return out;
}

LinearStudy study_of(const std::vector<ExperimentRecord>& people) {
  return study_from<LinearStudy>(people, [](const pb::ExperimentTrial& trial, int person) {
    const pb::LinearTrial& linear = trial.linear();
    return LinearStudyTrial{person, mode_of(linear), static_cast<int>(linear.number()),
                            static_cast<int>(linear.attempt()), result_of(linear)};
  });
}

ScrewStudy screw_study_of(const std::vector<ExperimentRecord>& people) {
  return study_from<ScrewStudy>(people, [](const pb::ExperimentTrial& trial, int person) {
    const pb::ScrewTrial& screw = trial.screw();
    return ScrewStudyTrial{person, mode_of(screw), static_cast<int>(screw.number()),
                           static_cast<int>(screw.attempt()), result_of(screw)};
  });
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
  const std::string& experiment = people.front().subject.experiment();
  if (experiment == "screw-fastening") {
    return (json ? screw_json : screw_table)(header_of(people), BumperSettings::Form::kDefault,
                                             screw_study_of(people), {});
  }
  if (experiment != "linear-movement") return wall_results_text(people, json);
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
