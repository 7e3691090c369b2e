// What people are asked after the trials of a gearshift or a wrench (dissertation 2.4), and how.
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <span>
#include <string>

#include "proto/experiment.pb.h"

namespace handrail {

inline constexpr unsigned kLeastScore = 1, kMostScore = 5;

// How far one agrees with it is its score. Published: of eight people (Fig. 2.11).
struct Statement {
  const char* name;  // in the files
  const char* text;
  double mean, median;
  double min = 0.0, max = 0.0;  // 0: not published
};

// None of other experiments.
std::span<const Statement> statements_of(const std::string& experiment);

// The score of that name; 0: not answered.
unsigned score_of(const pb::ExperimentAnswers& answers, const std::string& statement);

// Asks for what `before` has no score of. An answer that is none is said and asked for again; at
// the input's end the rest stays without one.
pb::ExperimentAnswers ask(std::span<const Statement> statements,
                          const pb::ExperimentAnswers& before, std::istream& in, std::ostream& out);

}  // namespace handrail
