#include "server/lab/sequences/sequence_command.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <filesystem>

#include "server/lab/console/console.h"
#include "server/lab/faults/fault_journal.h"
#include "server/lab/sequences/sequence_runs.h"
#include "server/lab/sequences/tool_cases.h"

namespace handrail {
namespace {

int run_cases(const SequenceCommand& command, const std::atomic<bool>& cancelled) {
  Progress progress;
  const std::vector<ToolCase> rows =
      run_tool_cases(command.threads, cancelled, [&progress](std::size_t done, std::size_t of) {
        progress.show(fmt::format("{} of {} cases", done, of));
      });
  progress.clear();
  if (rows.empty()) return complain(Status::error("cancelled"), kCancelled);
  std::fputs((command.json ? tool_cases_json(rows) : tool_cases_table(rows)).c_str(), stdout);
  const std::size_t failed = failures_of(rows);
  if (failed == 0) return kDone;
  return complain(Status::error(fmt::format("{} of {} cases fail", failed, rows.size())), kFailed);
}

// Where to begin; with `resume`, where the file's run ended.
Result<SequenceRun> begin_run(const SequenceCommand& command, const std::string& judge) {
  SequenceRun begin;
  begin.first = command.seed;
  if (command.results.empty()) return begin;
  std::error_code ignored;
  if (!std::filesystem::exists(command.results, ignored)) return begin;
  if (!command.resume) {
    return Status::error(command.results +
                         ": is there already; expected --resume to go on from it, or another name");
  }
  auto run = load_run(command.results, judge);
  if (run && run.value().first != command.seed) {
    return Status::error(fmt::format("{}: results from seed {} on; expected --seed {}",
                                     command.results, run.value().first, run.value().first));
  }
  return run;
}

}  // namespace

int run_sequence_command(const SequenceCommand& command, const std::atomic<bool>& cancelled) {
  if (command.cases) return run_cases(command, cancelled);
  if (command.resume && command.results.empty()) {
    return complain(Status::error("--resume: nothing to go on from; expected --results FILE"),
                    kUsage);
  }
  const auto judge = program_hash();
  if (!judge) return complain(judge.status(), kFailed);
  auto begun = begin_run(command, judge.value());
  if (!begun) return complain(begun.status(), kUsage);
  SequenceRun& run = begun.value();
  Progress progress;
  const auto finished = run_sequences(
      run, command.sequences, command.threads, cancelled, [&](const SequenceRun& now) {
        progress.show(fmt::format("{} of {} sequences", now.figures.sequences, command.sequences));
        return command.results.empty() ? Status::ok()
                                       : save_run(command.results, judge.value(), now);
      });
  progress.clear();
  if (!finished) return complain(finished.status(), kFailed);
  if (!finished.value()) {
    return complain(
        Status::error(fmt::format("cancelled after {} sequences{}", run.figures.sequences,
                                  command.results.empty() ? "" : "; --resume goes on from there")),
        kCancelled);
  }
  std::fputs((command.json ? sequence_json(run) : sequence_table(run)).c_str(), stdout);
  if (run.figures.holds()) return kDone;
  return complain(Status::error("a bound is broken"), kFailed);
}

}  // namespace handrail
