// Whether a hand can use a painted map: what it can reach, and what is too narrow to be felt right.
#pragma once

#include <string>
#include <vector>

#include "server/model/walls.h"

namespace handrail {

struct MapCheck {
  std::string problem;                // the start is useless; empty: none
  std::vector<std::string> warnings;  // one sentence each, with place
};

// Of painted `walls`, complete but for warnings. A problem: the start is outside the map or in a
// wall that stands at the first stage, an aisle cannot be reached from it at any stage, or hardly
// any free space can. Warns of free space out of reach, of aisles narrower than two pixels and of
// walls thinner than one.
MapCheck check_map(const Walls& walls);

}  // namespace handrail
