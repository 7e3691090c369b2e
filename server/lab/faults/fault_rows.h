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
// Of programs, clocks and other masters: P1, P5, C2, X2b, X9a.
const std::vector<FaultRow>& process_rows();
// Of sensor, encoder, haptic device, stop circuit and servos: S1 to S5.
const std::vector<FaultRow>& device_rows();

// In contact: N3c, P1c, S1d, S2c, S3c to S3e.
const std::vector<FaultRow>& contact_rows();
// Of sessions and operators: N1d, S6, X4, X8, P8, X9b.
const std::vector<FaultRow>& session_rows();
// Of the guard alone: X2a.
const std::vector<FaultRow>& guard_rows();

// All of them, in the matrix's order.
std::vector<FaultRow> fault_rows();

// A run that did not even engage.
FaultOutcome not_engaged();

}  // namespace handrail
