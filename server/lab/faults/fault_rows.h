// The fault matrix: what each row puts in and what must hold.
#pragma once

#include <cstdint>
#include <vector>

#include "server/lab/faults/fault_run.h"

namespace handrail {

struct FaultRow {
  const char* id;
  const char* what;  // for people
  const char* unit;  // of worst and bound
  int runs;
  // Run `index` of the row, with a seed of its own.
  FaultOutcome (*run)(std::uint64_t seed, int index);
};

// Of the network: N1 to N6, N9 to N11, N13.
const std::vector<FaultRow>& network_rows();
// Of programs, clocks and other masters: P1, P5, C2, X2, X9.
const std::vector<FaultRow>& process_rows();
// Of sensor, encoder, haptic device, stop circuit and servos: S1 to S5.
const std::vector<FaultRow>& device_rows();

// All of them, in the matrix's order.
std::vector<FaultRow> fault_rows();

// A run that did not even engage.
FaultOutcome not_engaged();

}  // namespace handrail
