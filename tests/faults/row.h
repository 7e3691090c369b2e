// The rows that are run with real programs: what each does, and what it asks.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace handrail::faults {

// What a run of a row is given.
struct RowRun {
  std::uint64_t seed = 1;
  bool full = false;  // the matrix's levels and spans, not a minute's choice of them
  bool (*interrupted)() = nullptr;
  std::string keep;  // folder for what a run that failed leaves
};

enum class Outcome { kPassed, kFailed, kSkipped, kStopped };

struct RowResult {
  Outcome outcome = Outcome::kPassed;
  std::string done, measured, asked;
  std::string why;  // it failed, or was skipped
};

struct FaultRow {
  const char* id;
  const char* what;
  const char* in_lab;  // the rows of handrail-lab faults that are nearest to it; empty: none
  RowResult (*run)(const RowRun& run);
};

// In the matrix's order.
std::span<const FaultRow> all_rows();

// What each row does. A new one is named here, written in its file, and listed in row_table.cc.
namespace rows {
using Row = RowResult(const RowRun& run);
// network_rows.cc
Row n1, n2, n3, n11, n13;
// order_rows.cc
Row n4, n5, n6, n7, n8;
// outage_rows.cc
Row n9, n10, n12;
// program_rows.cc
Row p1, p2, p3, p4, s4;
// clock_rows.cc
Row c1, c2;
// disk_rows.cc
Row d1, d2;
// stranger_rows.cc
Row x3, x4, x5, x10;
}  // namespace rows

}  // namespace handrail::faults
