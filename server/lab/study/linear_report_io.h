// What a linear-movement study found, as JSON (proto/study.proto) and as tables to read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/lab/study/linear_study.h"

namespace handrail {

// How the study was made.
struct StudyHeader {
  std::string scene;
  std::string population;
  std::uint32_t seed = 1;
  int operators = 0;
  int trials = 0;  // successful ones wanted of each operator in each mode
};

// A study made again with something varied.
struct StudyVariation {
  std::string setting;  // as given, such as "rig.servo_spread=0.1"
  StudyResult result;
};

// Deterministic: the bootstrap is seeded with the study's seed.
std::string linear_json(const StudyHeader& header, const StudyResult& study,
                        const std::vector<StudyVariation>& variations);
std::string linear_table(const StudyHeader& header, const StudyResult& study,
                         const std::vector<StudyVariation>& variations);

}  // namespace handrail
