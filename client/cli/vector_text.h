// Numbers and vectors as a user types them.
#pragma once

#include <string>

#include "server/base/spatial.h"
#include "server/base/status.h"

namespace handrail {

// "350,0,429": three finite numbers. `flag`, `unit` and `example` only make the error clear:
// "--at: '100mm,0,0': expected three numbers in mm, such as 350,0,429".
Result<Vec3> parse_vector(const std::string& flag, const std::string& text, const std::string& unit,
                          const std::string& example);

// "x", "+y", "-z", or three numbers of any length but zero.
Result<Vec3> parse_direction(const std::string& flag, const std::string& text);

// One finite number within [min, max].
Result<double> parse_number(const std::string& flag, const std::string& text, double min,
                            double max, const std::string& unit);

}  // namespace handrail
