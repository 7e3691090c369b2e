// What a screw-fastening study found, as JSON (proto/screw_study.proto) and as tables to read.
#pragma once

#include <string>
#include <vector>

#include "server/lab/study/screw/screw_study.h"

namespace handrail {

namespace pb {
class ScrewTrial;
}  // namespace pb

using ScrewVariation = StudyVariation<ScrewStudy>;

// "published" or "default".
const char* name_of(BumperSettings::Form form) noexcept;

// `bumper`: in the modes with protection. Deterministic: the bootstrap is seeded with the study's
// seed.
std::string screw_json(const StudyHeader& header, BumperSettings::Form bumper,
                       const ScrewStudy& study, const std::vector<ScrewVariation>& variations);
// Ends with the sizes of the dissertation that are and are not reproduced, and the targets.
std::string screw_table(const StudyHeader& header, BumperSettings::Form bumper,
                        const ScrewStudy& study, const std::vector<ScrewVariation>& variations);

// One trial, to JSON and back; its trace and the simulated time are not told.
void fill(const ScrewStudyTrial& trial, pb::ScrewTrial& out);
ScrewResult result_of(const pb::ScrewTrial& trial);

}  // namespace handrail
