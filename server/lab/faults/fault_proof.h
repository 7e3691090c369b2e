// That the fault matrix needs every check: with one left out, a row of it turns red.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/base/deletable.h"
#include "server/lab/faults/fault_rows.h"

namespace handrail {

// A check, and the row that shows what it is good for.
struct FaultProof {
  Check check;
  const char* name;        // for --delete
  const char* row;         // id
  int runs;                // the first so many of the row
  const char* found;       // what they find without the check, and do not with it
  std::uint64_t with = 0;  // left out as well, a bit for each: would find the same by chance
  std::uint64_t seed = 0;  // of the runs, where what they find is rare; 0: the one asked for
};

// One for each check, in their order.
std::span<const FaultProof> fault_proofs();

// Leaves the check `name` out from now on, and what covers for it. False: no such check, or a build
// that always makes them all. Not while anything runs.
bool delete_check(const std::string& name);

struct ProofResult {
  const FaultProof* proof = nullptr;
  int with = 0;     // runs that find it although the check is made
  int without = 0;  // runs that find it without
  bool proven() const { return with == 0 && without > 0; }
};

// Runs every proof with and without its check, on `threads` threads. Fewer when cancelled.
std::vector<ProofResult> prove_faults(std::uint64_t seed, int threads,
                                      const std::atomic<bool>& cancelled);

std::string proof_json(const std::vector<ProofResult>& results);
std::string proof_table(const std::vector<ProofResult>& results);

}  // namespace handrail
