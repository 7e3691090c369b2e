#include "server/lab/faults/fault_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>

#include "server/lab/console.h"
#include "server/lab/faults/fault_proof.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

struct Job {
  std::size_t row = 0;
  int index = 0;
};

// Every run of every row has its own people, network and rig.
std::uint64_t seed_of(std::uint64_t seed, const FaultRow& row, int index) {
  std::uint64_t out = seed;
  for (const char* c = row.id; *c != 0; ++c) out = out * 131 + static_cast<std::uint64_t>(*c);
  return out * 1000 + static_cast<std::uint64_t>(index);
}

// 95 % upper bound of the share of runs that fail when none of `runs` did.
double rule_of_three(int runs) { return 3.0 / runs; }

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
  result.violations += run.violations;
  result.settled = std::max(result.settled, run.settled);
  result.harder = std::max(result.harder, run.harder);
  result.deeper = std::max(result.deeper, run.deeper);
  ++result.runs;
}

}  // namespace

std::vector<FaultResult> run_faults(const std::vector<FaultRow>& rows, std::uint64_t seed,
                                    int threads, const std::atomic<bool>& cancelled) {
  std::vector<Job> jobs;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (int index = 0; index < rows[row].runs; ++index) jobs.push_back({row, index});
  }
  // Single runs are the long ones: begun first, no core waits for one at the end.
  std::stable_sort(jobs.begin(), jobs.end(),
                   [&](const Job& a, const Job& b) { return rows[a.row].runs < rows[b.row].runs; });
  std::vector<FaultOutcome> outcomes(jobs.size());
  std::vector<char> done(jobs.size(), 0);
  Progress progress;
  run_parallel(
      jobs.size(), threads,
      [&](std::size_t i) {
        const FaultRow& row = rows[jobs[i].row];
        outcomes[i] = row.run(seed_of(seed, row, jobs[i].index), jobs[i].index);
        done[i] = 1;
      },
      [&](std::size_t n) { progress.show(fmt::format("{} of {} runs", n, jobs.size())); },
      &cancelled);
  std::vector<FaultResult> results;
  for (const FaultRow& row : rows) {
    FaultResult result;
    result.row = &row;
    results.push_back(result);
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const FaultRow& row = rows[jobs[i].row];
    if (done[i] == 0) continue;
    add_run(results[jobs[i].row], outcomes[i], seed_of(seed, row, jobs[i].index), jobs[i].index);
  }
  return results;
}

int runs_that_find(const FaultRow& row, int runs, const char* what, std::uint64_t seed, int threads,
                   const std::atomic<bool>& cancelled) {
  const int used = std::min(runs, row.runs);
  std::atomic<int> found = 0;
  run_parallel(
      static_cast<std::size_t>(used), threads,
      [&](std::size_t i) {
        const int index = static_cast<int>(i);
        const FaultOutcome out = row.run(seed_of(seed, row, index), index);
        if (out.found.find(what) != std::string::npos) ++found;
      },
      [](std::size_t) {}, &cancelled);
  return found;
}

std::string fault_json(const std::vector<FaultResult>& results) {
  std::string out = "{\"rows\": [";
  for (const FaultResult& r : results) {
    out += fmt::format(
        "{}\n  {{\"row\": \"{}\", \"runs\": {}, \"violations\": {}, \"worst\": {:.6g}, "
        "\"bound\": {:.6g}, \"unit\": \"{}\"}}",
        &r == results.data() ? "" : ",", r.row->id, r.runs, r.violations, r.worst, r.bound,
        r.row->unit);
  }
  return out + "\n]}\n";
}

std::string fault_table(const std::vector<FaultResult>& results) {
  std::string out = fmt::format("  {:<5}{:<60}{:>5}{:>12}{:>11}{:>11}  {:<18}{}\n", "row", "",
                                "runs", "violations", "worst", "bound", "unit", "95 % upper bound");
  for (const FaultResult& r : results) {
    const std::string upper =
        r.violations == 0 ? fmt::format("{:.2g} of runs", std::min(1.0, rule_of_three(r.runs)))
                          : fmt::format("run {}: {}", r.shown_index, r.found);
    out += fmt::format("  {:<5}{:<60}{:>5}{:>12}{:>11.4g}{:>11.4g}  {:<18}{}\n", r.row->id,
                       r.row->what, r.runs, r.violations, r.worst, r.bound, r.row->unit, upper);
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

namespace {

int prove(const FaultCommand& command, const std::atomic<bool>& cancelled) {
  const auto results = prove_faults(command.seed, command.threads, cancelled);
  if (cancelled) return complain(Status::error("cancelled"), kCancelled);
  std::fputs((command.json ? proof_json(results) : proof_table(results)).c_str(), stdout);
  const bool all =
      std::all_of(results.begin(), results.end(), [](const ProofResult& r) { return r.proven(); });
  return all ? kDone : kFailed;
}

}  // namespace

int run_fault_command(const FaultCommand& command, const std::atomic<bool>& cancelled) {
  if (!kDeletable && (command.prove || !command.without.empty())) {
    return complain(Status::error("this build always makes every check; cmake --preset deletable "
                                  "makes one that can leave them out"),
                    kUsage);
  }
  if (command.prove) return prove(command, cancelled);
  if (!command.without.empty() && !delete_check(command.without)) {
    std::string known;
    for (const FaultProof& proof : fault_proofs()) known += std::string(" ") + proof.name;
    return complain(Status::error("no check '" + command.without + "'; there are" + known), kUsage);
  }
  std::vector<FaultRow> rows;
  for (const FaultRow& row : fault_rows()) {
    if (std::string(row.id).starts_with(command.row)) rows.push_back(row);
  }
  // N1 is N1a and N1b, not N10 and up.
  const auto exact = [&](const FaultRow& row) {
    const std::string rest = std::string(row.id).substr(command.row.size());
    return rest.empty() || (rest.size() == 1 && rest[0] >= 'a' && rest[0] <= 'z');
  };
  if (!command.row.empty()) {
    rows.erase(std::remove_if(rows.begin(), rows.end(), [&](const auto& r) { return !exact(r); }),
               rows.end());
  }
  if (rows.empty()) {
    std::string known;
    for (const FaultRow& row : fault_rows()) known += std::string(" ") + row.id;
    return complain(Status::error("no row '" + command.row + "'; there are" + known), kUsage);
  }
  const auto results = run_faults(rows, command.seed, command.threads, cancelled);
  if (cancelled) return complain(Status::error("cancelled"), kCancelled);
  std::fputs((command.json ? fault_json(results) : fault_table(results)).c_str(), stdout);
  const bool clean = std::all_of(results.begin(), results.end(),
                                 [](const FaultResult& r) { return r.violations == 0; });
  return clean ? kDone : kFailed;
}

}  // namespace handrail
