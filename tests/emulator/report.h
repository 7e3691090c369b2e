// What a run of the emulator was like, for people and for programs.
#pragma once

#include <string>

#include "tests/emulator/emulator.h"

namespace handrail::emulator {

// A table with a column for each direction.
std::string for_people(const Report& report);
// One line.
std::string to_json(const Report& report);

}  // namespace handrail::emulator
