// Outcomes of runs in a file: an interrupted matrix goes on where it was.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "server/base/status.h"
#include "server/lab/faults/fault_run.h"

namespace handrail {

// A text file: what judged the runs in its first line, then a line for each run. A line is written
// whole or not at all, and what a kill leaves of one is dropped. Not for several threads at a time.
class FaultJournal {
 public:
  // Opens `path` or makes it. `judge` stands for whatever an outcome depends on beside the run's
  // own numbers: a file that another judge wrote is refused, as is one that is no journal, or that
  // another program has open.
  static Result<FaultJournal> open(const std::string& path, const std::string& judge);

  FaultJournal(FaultJournal&& other) noexcept;
  FaultJournal& operator=(FaultJournal&&) = delete;
  ~FaultJournal();

  // Null: not yet run.
  const FaultOutcome* find(const std::string& row, std::uint64_t seed, int index) const;
  Status append(const std::string& row, std::uint64_t seed, int index, const FaultOutcome& run);

 private:
  FaultJournal(std::string path, int file) : path_(std::move(path)), file_(file) {}
  Status read(const std::string& judge);
  bool take(std::string_view line);
  Status write(const std::string& line);

  std::string path_;
  int file_ = -1;
  std::map<std::tuple<std::string, std::uint64_t, int>, FaultOutcome> runs_;
};

// Names this program by its own bytes: another build is another judge.
Result<std::string> program_hash();

}  // namespace handrail
