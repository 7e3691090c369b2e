// What handrail-desk found, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "tests/desk/loop_trial.h"
#include "tests/desk/spacenavd_soak.h"

namespace handrail::desk {

std::string soak_text(const SoakPlan& plan, const SoakFigures& figures);
std::string soak_json(const SoakPlan& plan, const SoakFigures& figures);

// The first of `series` is what the others are compared with.
std::string loop_table(const std::vector<LoopSeries>& series);
std::string loop_json(const std::vector<LoopSeries>& series);
// Each was read and drove, and neither its lateness nor its work grows by more than kMostGrowth.
bool within_growth(const std::vector<LoopSeries>& series);

}  // namespace handrail::desk
