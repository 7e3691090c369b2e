// Accuracy against time, and what a scene simulates, as text for programs and for people.
#pragma once

#include <string>

#include "server/lab/scenes/explain.h"
#include "server/lab/scenes/row.h"

namespace handrail {

std::string accuracy_json(const AccuracyRows& rows);
// One table a choice; efficient rows carry a star.
std::string accuracy_table(const AccuracyRows& rows);

std::string explanation_json(const Explanation& explanation);
std::string explanation_table(const Explanation& explanation);

}  // namespace handrail
