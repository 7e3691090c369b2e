#include "server/lab/faults/fault_runner.h"

#include <algorithm>
#include <mutex>

#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

struct Job {
  std::size_t row = 0;
  std::size_t seed = 0;
  int index = 0;
};

// Every run of every row has its own people, network and rig.
std::uint64_t seed_of(std::uint64_t seed, const FaultRow& row, int index) {
  std::uint64_t out = seed;
  for (const char* c = row.id; *c != 0; ++c) out = out * 131 + static_cast<std::uint64_t>(*c);
  return out * 1000 + static_cast<std::uint64_t>(index);
}

// Seed by seed. Of each the rows of few runs first: those are the long ones, and no core waits for
// one at the end.
std::vector<Job> jobs_of(const FaultRuns& what) {
  std::vector<std::size_t> order(what.rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return what.rows[a].runs < what.rows[b].runs;
  });
  std::vector<Job> jobs;
  for (std::size_t seed = 0; seed < what.seeds.size(); ++seed) {
    for (const std::size_t row : order) {
      const int runs = what.quick ? what.rows[row].quick_runs : what.rows[row].runs;
      for (int index = 0; index < runs; ++index) jobs.push_back({row, seed, index});
    }
  }
  return jobs;
}

}  // namespace

Result<std::vector<FaultResult>> run_faults(
    const FaultRuns& what, const std::atomic<bool>& cancelled, FaultJournal* journal,
    const std::function<void(const FaultProgress&)>& progress) {
  const std::vector<Job> jobs = jobs_of(what);
  std::vector<std::optional<FaultOutcome>> outcomes(jobs.size());
  std::mutex guarded;  // all below
  Status written = Status::ok();
  FaultProgress now;
  now.of = jobs.size();
  std::vector<std::size_t> left(what.seeds.size(), jobs.size() / what.seeds.size());
  std::vector<std::uint64_t> of_seed(what.seeds.size(), 0);
  std::atomic<bool> ends = false;
  if (progress) progress(now);
  run_parallel(
      jobs.size(), what.threads,
      [&](std::size_t i) {
        const Job& job = jobs[i];
        const FaultRow& row = what.rows[job.row];
        const std::uint64_t seed = what.seeds[job.seed];
        const FaultOutcome* known = nullptr;
        {
          const std::lock_guard lock(guarded);
          if (journal != nullptr) known = journal->find(row.id, seed, job.index);
        }
        FaultOutcome out = known != nullptr
                               ? *known
                               : row.run({seed_of(seed, row, job.index), job.index,
                                          what.quick ? kQuickShare : 1.0, what.replay});
        const std::lock_guard lock(guarded);
        if (journal != nullptr && known == nullptr && written) {
          written = journal->append(row.id, seed, job.index, out);
        }
        ends = !written || cancelled;
        ++now.runs;
        now.violations += out.violations;
        now.of_seed = of_seed[job.seed] += out.violations;
        now.seed_done = --left[job.seed] == 0 ? &what.seeds[job.seed] : nullptr;
        outcomes[i] = std::move(out);
        if (progress) progress(now);
      },
      {}, &ends);
  if (!written) return written;
  std::vector<FaultResult> results(what.rows.size());
  for (std::size_t row = 0; row < results.size(); ++row) results[row].row = &what.rows[row];
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!outcomes[i]) continue;
    add_run(results[jobs[i].row], *outcomes[i], what.seeds[jobs[i].seed], jobs[i].index);
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
        const FaultOutcome out = row.run({seed_of(seed, row, index), index});
        if (out.found.find(what) != std::string::npos) ++found;
      },
      [](std::size_t) {}, &cancelled);
  return found;
}

}  // namespace handrail
