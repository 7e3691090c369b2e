// Many sequences: on all cores, and in a file that an interrupted run goes on from.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "server/base/status.h"
#include "server/lab/sequences/sequence.h"

namespace handrail {

// The sequences from `first` on, one seed each.
struct SequenceRun {
  std::uint64_t first = 0;    // seed
  SequenceFigures figures{};  // of the `figures.sequences` that are done
};

// Goes on until `of` sequences are done, in rounds; what a cancelled round has come to is dropped.
// `round` is told after each; what it returns that is no success ends the run. The result does not
// depend on `threads` (0: one a core), nor on where a run was interrupted. False: cancelled.
Result<bool> run_sequences(SequenceRun& run, std::uint64_t of, int threads,
                           const std::atomic<bool>& cancelled,
                           const std::function<Status(const SequenceRun&)>& round);

// A text file of one run. `judge` names the program: the numbers of another are not gone on from.
Status save_run(const std::string& path, const std::string& judge, const SequenceRun& run);
Result<SequenceRun> load_run(const std::string& path, const std::string& judge);

std::string sequence_table(const SequenceRun& run);
std::string sequence_json(const SequenceRun& run);

}  // namespace handrail
