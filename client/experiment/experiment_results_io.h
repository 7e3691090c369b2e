// From what was written down of people to the study's results, and from trials to lines.
#pragma once

#include <string>
#include <vector>

#include "client/experiment/experiment_file_io.h"
#include "server/base/time.h"
#include "server/lab/study/linear/linear_study.h"
#include "server/lab/study/screw/screw_study.h"

namespace handrail {

// Of the bootstrap: the same files give the same table.
inline constexpr std::uint32_t kReportSeed = 1;

// A trial of linear movement, or of screw fastening, as it stands in the file before it has ended.
pb::ExperimentTrial trial_line(const TrialNext& next);
pb::ExperimentTrial screw_line(const TrialNext& next);
// What it has come to.
void fill_ended(const TrialNext& next, const TrialResult& result, pb::ExperimentTrial& out);
void fill_ended(const TrialNext& next, const ScrewResult& result, pb::ExperimentTrial& out);

// What a recording has where the next trial of `person` begins or ends.
std::string trial_mark(const std::string& what, const ExperimentRecord& person,
                       const std::string& mode, const std::string& how);
// How it ended, as the file has it.
std::string end_of(const pb::ExperimentTrial& trial);

// What next_trial() asks for.
std::vector<TrialMade> trials_made(const ExperimentRecord& record);

// The counted trials of these people, in their order: practice and interrupted trials are left out.
LinearStudy study_of(const std::vector<ExperimentRecord>& people);
ScrewStudy screw_study_of(const std::vector<ExperimentRecord>& people);
// How the study was made. All people are simulated, or none.
StudyHeader header_of(const std::vector<ExperimentRecord>& people);

// Of linear movement and screw fastening the study's own table or JSON, of the others
// wall_results_text().
std::string results_text(const std::vector<ExperimentRecord>& people, bool json);

// "2026-11-27T12:24:53Z", of a time since 1970.
std::string calendar_text(Nanos since_1970);

}  // namespace handrail
