#include "server/lab/faults/fault_results.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace handrail {
namespace {

// 95 % upper bound of the share of runs that fail when none of `runs` did.
double rule_of_three(int runs) { return std::min(1.0, 3.0 / runs); }

// How to see the first violation again, what it is, and at which other seeds there are some.
std::string story_of(const FaultResult& r) {
  constexpr std::size_t kNamed = 8;
  std::string out = fmt::format("seed {}, run {}: {}", r.shown_seed, r.shown_index, r.found);
  if (r.red_seeds.size() < 2) return out;
  const std::size_t named = std::min(r.red_seeds.size(), kNamed);
  out += fmt::format("; seeds {}", fmt::join(r.red_seeds.data(), r.red_seeds.data() + named, ", "));
  if (named < r.red_seeds.size()) out += fmt::format(" and {} more", r.red_seeds.size() - named);
  return out;
}

}  // namespace

void add_run(FaultResult& result, const FaultOutcome& run, std::uint64_t seed, int index) {
  const bool first_bad = result.violations == 0 && run.violations > 0;
  const bool nearer =
      run.measured && (!result.measured || run.worst - run.bound > result.worst - result.bound);
  if (nearer) {
    result.measured = true;
    result.worst = run.worst;
    result.bound = run.bound;
  }
  if (result.runs == 0 || first_bad || (nearer && result.violations == 0)) {
    result.shown_seed = seed;
    result.shown_index = index;
    result.found = run.found;
  }
  if (run.violations > 0 && (result.red_seeds.empty() || result.red_seeds.back() != seed)) {
    result.red_seeds.push_back(seed);
  }
  result.violations += run.violations;
  result.settled = std::max(result.settled, run.settled);
  result.harder = std::max(result.harder, run.harder);
  result.deeper = std::max(result.deeper, run.deeper);
  ++result.runs;
}

std::uint64_t violations_of(const std::vector<FaultResult>& results) {
  return std::accumulate(
      results.begin(), results.end(), std::uint64_t{0},
      [](std::uint64_t sum, const FaultResult& r) { return sum + r.violations; });
}

std::string fault_json(const std::vector<FaultResult>& results) {
  std::string out = "{\"rows\": [";
  for (const FaultResult& r : results) {
    out += fmt::format(
        "{}\n  {{\"row\": \"{}\", \"runs\": {}, \"violations\": {}, \"worst\": {:.6g}, "
        "\"bound\": {:.6g}, \"unit\": \"{}\", \"seeds_with_violations\": [{}]}}",
        &r == results.data() ? "" : ",", r.row->id, r.runs, r.violations, r.worst, r.bound,
        r.row->unit, fmt::join(r.red_seeds, ", "));
  }
  return out + "\n]}\n";
}

std::string fault_table(const std::vector<FaultResult>& results) {
  std::string out = fmt::format("  {:<5}{:<60}{:>5}{:>12}{:>11}{:>11}  {:<20}{}\n", "row", "",
                                "runs", "violations", "worst", "bound", "unit", "95 % upper bound");
  for (const FaultResult& r : results) {
    const std::string last =
        r.violations > 0 ? story_of(r) : fmt::format("{:.2g} of runs", rule_of_three(r.runs));
    out += fmt::format("  {:<5}{:<60}{:>5}{:>12}{:>11.4g}{:>11.4g}  {:<20}{}\n", r.row->id,
                       r.row->what, r.runs, r.violations, r.worst, r.bound, r.row->unit, last);
  }
  double settled = 0.0;
  for (const FaultResult& r : results) settled = std::max(settled, r.settled);
  if (settled > 0.0) {
    out += fmt::format(
        "  the simulated arm's joints moved on for up to {:.0f} ms after the last "
        "command of a stop\n",
        settled);
  }
  for (const FaultResult& r : results) {
    if (r.harder <= 0.0) continue;
    out += fmt::format(
        "  {}: a stop that had set in still pushed up to {:.0f} N harder, {:.1f} mm further in\n",
        r.row->id, r.harder, r.deeper);
  }
  return out;
}

}  // namespace handrail
