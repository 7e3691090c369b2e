// What a linear-movement study found, as JSON (proto/study.proto) and as tables to read.
#pragma once

#include <string>
#include <vector>

#include "server/lab/study/linear/linear_study.h"

namespace handrail {

using LinearVariation = StudyVariation<LinearStudy>;

// Deterministic: the bootstrap is seeded with the study's seed.
std::string linear_json(const StudyHeader& header, const LinearStudy& study,
                        const std::vector<LinearVariation>& variations);
std::string linear_table(const StudyHeader& header, const LinearStudy& study,
                         const std::vector<LinearVariation>& variations);

}  // namespace handrail
