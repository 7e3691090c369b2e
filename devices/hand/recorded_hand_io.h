// Reads recorded hand motions from CSV files.
#pragma once

#include <istream>
#include <string>

#include "devices/hand/recorded_hand.h"
#include "server/base/status.h"

namespace handrail {

// Reads a file whose first line is `t_s,x_mm,y_mm` or `t_s,x_mm,y_mm,z_mm` and whose further lines
// hold numbers: seconds, rising by at least 1 us each, and millimetres within +-100 m. x, y and z
// become M's X, Y and Z; without z the motion stays in the plane Z = 0. Windows line ends, blanks
// around values and empty lines at the end are accepted. The error names file, line, value and what
// was expected. May block and allocate.
Result<RecordedMotion> load_recorded_motion(const std::string& path);

// The same from a stream; `name` stands for the file in errors.
Result<RecordedMotion> read_recorded_motion(std::istream& in, const std::string& name);

}  // namespace handrail
