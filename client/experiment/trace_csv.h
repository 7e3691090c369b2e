// A trial's way as CSV, at the robot's rate.
#pragma once

#include <string>
#include <vector>

#include "server/base/spatial.h"
#include "server/base/status.h"
#include "server/model/linear_task.h"

namespace handrail {

struct TraceRow {
  double time = 0.0;          // the master's clock [s]
  Pose X_ST;                  // measured
  Pose X_SU;                  // commanded
  Vec3 p_MH = Vec3::Zero();   // the hand [m]
  Vec3 f_H_M = Vec3::Zero();  // the force on it [N]
  LinearPhase phase = LinearPhase::kToB;
};

// Of the how manieth trial that was begun.
std::string trace_file(const std::string& folder, const std::string& experiment,
                       const std::string& subject, int trial);

// A head line with units, then a line a row; times from the first row's. Nothing for no rows. The
// error names the file.
Status write_trace(const std::string& file, const std::vector<TraceRow>& rows);

// Of a trace, the named columns, a row a line. A last line that is cut off is left out. The error
// names the file, the line and the column, or says that there is no such file.
Result<std::vector<std::vector<double>>> read_trace(const std::string& file,
                                                    const std::vector<std::string>& columns);

}  // namespace handrail
