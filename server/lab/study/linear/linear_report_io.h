// What a linear-movement study found, as JSON (proto/study.proto) and as tables to read.
#pragma once

#include <string>
#include <vector>

#include "server/lab/study/linear/linear_study.h"

namespace handrail {

namespace pb {
class LinearTrial;
}  // namespace pb

using LinearVariation = StudyVariation<LinearStudy>;

// Deterministic: the bootstrap is seeded with the study's seed.
std::string linear_json(const StudyHeader& header, const LinearStudy& study,
                        const std::vector<LinearVariation>& variations);
std::string linear_table(const StudyHeader& header, const LinearStudy& study,
                         const std::vector<LinearVariation>& variations);

// One trial, to JSON and back; its trace and the simulated time are not told.
void fill(const LinearStudyTrial& trial, pb::LinearTrial& out);
TrialResult result_of(const pb::LinearTrial& trial);

}  // namespace handrail
