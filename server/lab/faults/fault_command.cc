#include "server/lab/faults/fault_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <optional>

#include "server/base/output.h"
#include "server/lab/console/console.h"
#include "server/lab/faults/fault_proof.h"
#include "server/lab/faults/fault_runner.h"
#include "server/lab/faults/fault_seeds.h"

namespace handrail {
namespace {

// N1 is N1a and N1b, not N10 and up.
bool is_named(const std::string& id, const std::string& name) {
  if (name.empty() || id == name) return true;
  return id.starts_with(name) && id.size() == name.size() + 1 && id.back() >= 'a' &&
         id.back() <= 'z';
}

int prove(const FaultCommand& command, std::uint64_t seed, const std::atomic<bool>& cancelled) {
  const auto stopped = [] { return complain(Status::error("cancelled"), kCancelled); };
  // A proof counts runs alone: one cut short is nothing to keep.
  const auto results = run_until_cancelled(
      [&] { return prove_faults(seed, command.threads, cancelled); }, cancelled, stopped);
  if (cancelled) return stopped();
  std::fputs((command.json ? proof_json(results) : proof_table(results)).c_str(), stdout);
  const bool all =
      std::all_of(results.begin(), results.end(), [](const ProofResult& r) { return r.proven(); });
  return all ? kDone : kFailed;
}

// A line on the terminal that is written over; on several seeds also one for each that is done.
class FaultConsole {
 public:
  explicit FaultConsole(std::size_t seeds) : several_(seeds > 1) {}
  void show(const FaultProgress& now) {
    if (several_ && now.seed_done != nullptr) {
      line_.clear();
      std::fprintf(stderr, "seed %llu done: %llu violations\n",
                   static_cast<unsigned long long>(*now.seed_done),
                   static_cast<unsigned long long>(now.of_seed));
    }
    line_.show(fmt::format("{} of {} runs, {} violations", now.runs, now.of, now.violations));
  }

 private:
  bool several_;
  Progress line_;
};

int run_rows(const FaultCommand& command, const FaultRuns& what,
             const std::atomic<bool>& cancelled) {
  std::optional<FaultJournal> journal;
  if (!command.results.empty()) {
    const Result<std::string> program = program_hash();
    if (!program) return complain(program.status(), kUsage);
    Result<FaultJournal> opened =
        FaultJournal::open(command.results, *program + (what.quick ? ", quick" : ", whole") +
                                                (what.replay ? ", replayed" : ""));
    if (!opened) return complain(opened.status(), kUsage);
    journal.emplace(std::move(*opened));
  }
  std::optional<NewFile> file;
  if (!command.out.empty()) {
    if (const Status s = file.emplace(command.out).opened(); !s) return complain(s, kUsage);
  }
  std::optional<FaultConsole> console(what.seeds.size());
  FaultProgress last;
  std::mutex guarded;  // both
  const auto stopped = [&] {
    console.reset();
    return complain(
        Status::error(fmt::format("stopped after {} of {} runs{}", last.runs, last.of,
                                  journal ? "; the same command goes on from " + command.results
                                          : "; with --results FILE it could go on")),
        kCancelled);
  };
  // Some runs take a minute. The journal has every one that has ended, so nobody waits for them.
  const Result<std::vector<FaultResult>> run = run_until_cancelled(
      [&] {
        return run_faults(what, cancelled, journal ? &*journal : nullptr,
                          [&](const FaultProgress& now) {
                            const std::lock_guard lock(guarded);
                            console->show(last = now);
                          });
      },
      cancelled,
      [&] {
        const std::lock_guard lock(guarded);
        file.reset();
        return stopped();
      });
  if (cancelled) return stopped();
  console.reset();
  if (!run) return complain(run.status(), kUsage);
  const std::uint64_t violations = violations_of(*run);
  const std::string text =
      fmt::format("handrail-lab faults{}{}{} --seeds {}: {} runs, {} violations\n",
                  command.row.empty() ? "" : " --row " + command.row, what.quick ? " --quick" : "",
                  what.replay ? " --replay" : "", command.seeds, last.of, violations) +
      fault_table(*run);
  std::fputs((command.json ? fault_json(*run) : text).c_str(), stdout);
  if (file) {
    const Status written = file->finish(text);
    if (!written) return complain(written, kUsage);
  }
  return violations == 0 ? kDone : kFailed;
}

}  // namespace

int run_fault_command(const FaultCommand& command, const std::atomic<bool>& cancelled) {
  if (!kDeletable && (command.prove || !command.without.empty())) {
    return complain(Status::error("this build always makes every check; cmake --preset deletable "
                                  "makes one that can leave them out"),
                    kUsage);
  }
  Result<std::vector<std::uint64_t>> seeds = parse_seeds(command.seeds);
  if (!seeds) return complain(seeds.status(), kUsage);
  if (command.prove && seeds->size() > 1) {
    return complain(Status::error("--prove takes one seed, not " + command.seeds), kUsage);
  }
  if (command.prove) return prove(command, seeds->front(), cancelled);
  if (!command.without.empty() && !delete_check(command.without)) {
    std::string known;
    for (const FaultProof& proof : fault_proofs()) known += std::string(" ") + proof.name;
    return complain(Status::error("no check '" + command.without + "'; there are" + known), kUsage);
  }
  std::vector<FaultRow> rows;
  std::string known;
  for (const FaultRow& row : fault_rows()) {
    if (is_named(row.id, command.row)) rows.push_back(row);
    known += std::string(" ") + row.id;
  }
  if (rows.empty()) {
    return complain(Status::error("no row '" + command.row + "'; there are" + known), kUsage);
  }
  return run_rows(command,
                  {rows, std::move(*seeds), command.quick, command.threads, command.replay},
                  cancelled);
}

}  // namespace handrail
