// The results of a storm in a file, so that an interrupted one goes on where it was.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "tests/storm/run.h"

namespace handrail::storm {

// One sequence in one line, tab-separated: seed, "ok" or "VIOLATED", seconds, targets, breaches,
// largest step, acceleration and jerk (of the limit), held cycles, late commands, halts, hardest
// halt (of the limit), what was done, what was violated.
struct Line {
  std::uint64_t seed = 0;
  bool ok = false;
  double seconds = 0.0;
  Figures figures;
  std::string done, violated;
};

Line line_of(const Sequence& sequence, const Outcome& outcome);
std::string to_line(const Line& line);
// The error names what is wrong with the line.
Result<Line> from_line(const std::string& line);

// What a person reads of one sequence, a line.
std::string for_people(const Line& line);

// All sequences together.
struct Summary {
  std::uint64_t ran = 0;
  std::vector<std::uint64_t> red;  // seeds of the violated ones
  Figures figures;

  void add(const Line& line);
  // Of sequences that are violated, with 95 % confidence, when none of those was: rule of three.
  double bound() const;
};
std::string for_people(const Summary& all);
std::string to_json(const Summary& all);

class Results {
 public:
  // Takes over what is in the file at `path`, which grows from here on; "" keeps nothing. A last
  // line that was not finished is dropped. The error names file, line and cause.
  Status open(const std::string& path);
  bool has(std::uint64_t seed) const { return known_.count(seed) != 0; }
  const Line& of(std::uint64_t seed) const { return known_.at(seed); }
  Status add(const Line& line);

 private:
  std::string path_;
  std::ofstream file_;
  std::map<std::uint64_t, Line> known_;
};

}  // namespace handrail::storm
