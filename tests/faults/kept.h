// Results of rows, in a folder: one file for each row, form, seed and commit.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/status.h"
#include "tests/faults/row.h"

namespace handrail::faults {

class KeptResults {
 public:
  // `commit`: what is tested; empty: nothing can be said of it later, and nothing is kept. The
  // folder is made with the first result.
  KeptResults(std::string folder, std::string commit, bool full)
      : folder_(std::move(folder)), commit_(std::move(commit)), form_(full ? "full" : "quick") {}

  Status add(const std::string& row, std::uint64_t seed, const RowResult& result) const;
  // The seed at which the row has passed, of any or of that one; nothing: it has not.
  std::optional<std::uint64_t> passed(const std::string& row,
                                      std::optional<std::uint64_t> seed) const;
  // Where a run that fails leaves its files.
  std::string room(const std::string& row, std::uint64_t seed) const;

 private:
  std::string start(const std::string& row) const { return row + "-" + form_ + "-"; }

  std::string folder_, commit_, form_;
};

// "PASS", "FAIL", "SKIPPED", "STOPPED".
const char* name_of(Outcome outcome);
// One line without its end.
std::string for_people(const std::string& row, const RowResult& result, double seconds);
std::string to_json(const std::string& row, std::uint64_t seed, bool full, const RowResult& result,
                    double seconds);

}  // namespace handrail::faults
