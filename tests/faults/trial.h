// A row as it goes: its beds, what they gave, and what was found.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/faults/bed.h"
#include "tests/faults/row.h"

namespace handrail::faults {

inline double in_ms(Nanos span) { return 1e3 * to_seconds(span); }

class Trial {
 public:
  // What every row asks beside its own: kEverywhere.
  Trial(const RowRun& run, std::string done, std::string asked);

  // Another bed, started and, unless `idle`, engaged; null: it could not be, and the row is over.
  std::unique_ptr<Bed> bed(BedOptions options = {}, bool idle = false);
  // Ends a bed and adds what it gave.
  BedVerdict end(std::unique_ptr<Bed> bed);

  bool over() const { return run_.interrupted != nullptr && run_.interrupted(); }
  // What was asked is not so.
  void check(bool so, const std::string& otherwise) {
    if (!so) found_.push_back(otherwise);
  }
  void measure(const std::string& text) { measured_.push_back(text); }
  // The row cannot be run here.
  void skip(const std::string& why) { skipped_ = why; }
  // Something that the row can do on this machine in part only.
  void left_out(const std::string& what) { measure("left out: " + what); }

  RowResult result() const;
  const RowRun& run() const { return run_; }
  std::uint64_t beds() const { return beds_; }

 private:
  // What a bed leaves, until the row is over; then only of one that failed.
  void keep(const Bed& bed) const;
  void keep_if(bool failed) const;

  RowRun run_;
  std::string done_, asked_, skipped_;
  std::vector<std::string> measured_, found_;
  std::uint64_t beds_ = 0;
  // Of all beds.
  storm::Figures limits_;
  std::uint64_t stops_ = 0;
  AuditedStop worst_;
  Nanos lateness_ = 0;
};

// The states of the master that the slave accepted, against those that arrived as the newest, and
// what arrived otherwise: says so, and asks that nothing else was accepted.
void judge_acceptance(Trial& trial, const BedVerdict& verdict);

}  // namespace handrail::faults
