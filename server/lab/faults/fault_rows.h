// The fault matrix: what each row puts in and what must hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/lab/faults/fault_run.h"

namespace handrail {

struct FaultRow {
  const char* id;
  const char* what;  // for people
  const char* unit;  // of worst and bound
  int runs;
  int quick_runs;  // in the quick form, at most `runs`
  FaultOutcome (*run)(const RowRun& run);
};

// Of the long spans, in the quick form.
inline constexpr double kQuickShare = 0.05;

// What each row does. A new one is named here, written in its file, and listed in row_table.cc.
namespace rows {
using Row = FaultOutcome(const RowRun& run);
// network_rows.cc
Row n1a, n1b, n1c, n2, n3, n4, n5, n6, n9, n10a, n10b, n11, n13;
// process_rows.cc
Row p1, p5, c2, x2b, x2d, x9a;
// device_rows.cc
Row s1a, s1b, s1c, s2a, s2b, s3a, s3b, s4, s5;
// robot_rows.cc
Row r1a, r1b, r2, r3, r3b, r3c, r4, r5;
// contact_rows.cc
Row n3c, p1c, s1d, s2c, s3c, s3d, s3e;
// trust_rows.cc
Row s1e, s1f, s2d, s2e, r1c;
// guard_rows.cc
Row x2a;
// session_rows.cc
Row n1d, s6, d3, x4, x11, p8, x9b;
// tool_rows.cc
Row x2c;
}  // namespace rows

// All rows, in the matrix's order.
std::span<const FaultRow> fault_rows();

// A run that did not even engage.
FaultOutcome not_engaged();

}  // namespace handrail
