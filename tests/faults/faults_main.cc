// handrail-faults: the fault matrix with the real programs, in two namespaces.
#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "client/cli/interrupt.h"
#include "server/base/clock.h"
#include "server/base/output.h"
#include "server/base/pacer.h"
#include "server/base/version.h"
#include "server/lab/console/console.h"
#include "tests/faults/faults_args.h"
#include "tests/faults/kept.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace {

using namespace handrail;
using namespace handrail::faults;

constexpr int kNotHere = 77;  // of handrail-netfault: this machine does not allow it

void say(const FaultsArgs& args, const FaultRow& row, const RowResult& result, double seconds) {
  const std::string line = args.json ? to_json(row.id, args.seed, args.full, result, seconds)
                                     : for_people(row.id, result, seconds);
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

// A program of this build, to its end: what it printed, and its code.
int run_to_end(const std::string& name, const std::vector<std::string>& words, std::string& out) {
  const TempFolder folder;
  Child child(name, words, folder.path() + "/out", true);
  while (child.running()) {
    if (interrupted()) return kCancelled;
    sleep_until(monotonic_now() + kMillisecond);
  }
  out = child.output();
  return child.code();
}

// Where there are no namespaces: the row's relatives in virtual time.
RowResult run_in_lab(const FaultRow& row, const FaultsArgs& args, const std::string& refused) {
  RowResult out;
  out.done = std::string("in virtual time, rows ") + row.in_lab;
  out.asked = "what handrail-lab faults asks";
  std::string ids = row.in_lab;
  if (ids.empty()) {
    out.outcome = Outcome::kSkipped;
    out.done = row.what;
    out.why = refused + "; it has no relative in virtual time";
    return out;
  }
  std::istringstream each(ids);
  for (std::string id; each >> id;) {
    std::string printed;
    std::vector<std::string> words = {"faults", "--row", id, "--seed", std::to_string(args.seed)};
    if (!args.full) words.emplace_back("--quick");
    const int code = run_to_end("handrail-lab", words, printed);
    if (interrupted()) out.outcome = Outcome::kStopped;
    if (interrupted()) return out;
    out.measured += (out.measured.empty() ? "" : ", ") + id + (code == 0 ? " passed" : " failed");
    if (code == 0) continue;
    out.outcome = Outcome::kFailed;
    out.why += id + ": " + printed;
  }
  return out;
}

int list(const FaultsArgs& args) {
  for (const FaultRow* row : args.rows) std::printf("%-4s %s\n", row->id, row->what);
  return kDone;
}

int run_rows(const FaultsArgs& args) {
  const char* commit = std::getenv("HANDRAIL_COMMIT");
  const KeptResults kept(std::filesystem::absolute(args.results).string(),
                         commit == nullptr ? "" : commit, args.full);
  std::string refused;
  const int trial = run_to_end("handrail-netfault", {"--", "near:", "true"}, refused);
  const bool here = trial != kNotHere;
  if (!here) std::fprintf(stderr, "handrail-faults: %s", refused.c_str());
  std::fprintf(stderr, "handrail-faults: %s form, seed %llu\n", args.full ? "full" : "quick",
               static_cast<unsigned long long>(args.seed));
  int failed = 0, skipped = 0;
  for (const FaultRow* row : args.rows) {
    const auto seed = args.seeded ? std::optional(args.seed) : std::nullopt;
    if (const auto passed = args.resume ? kept.passed(row->id, seed) : std::nullopt) {
      std::fprintf(stderr, "handrail-faults: %s has passed at this commit, seed %llu\n", row->id,
                   static_cast<unsigned long long>(*passed));
      continue;
    }
    const Nanos from = monotonic_now();
    const RowResult result =
        here ? row->run({args.seed, args.full, interrupted, kept.room(row->id, args.seed)})
             : run_in_lab(*row, args, refused);
    if (result.outcome == Outcome::kStopped) return kCancelled;
    failed += result.outcome == Outcome::kFailed ? 1 : 0;
    skipped += result.outcome == Outcome::kSkipped ? 1 : 0;
    say(args, *row, result, to_seconds(monotonic_now() - from));
    if (const Status added = kept.add(row->id, args.seed, result); !added) {
      std::fprintf(stderr, "handrail-faults: %s\n", added.message().c_str());
    }
  }
  std::fprintf(stderr, "handrail-faults: %d failed, %d skipped\n", failed, skipped);
  return failed == 0 ? kDone : kFailed;
}

int run(const std::vector<std::string>& words) {
  const Result<FaultsArgs> args = read_faults_args(words);
  if (!args) {
    std::fprintf(stderr, "handrail-faults: %s\n", args.message().c_str());
    return kUsage;
  }
  if (args->help) std::fputs(faults_usage().c_str(), stdout);
  if (args->help) return kDone;
  if (args->list) return list(*args);
  // Taps and sockets lie in memory where there is such a folder: no disk holds anybody up.
  if (std::filesystem::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 0);
  catch_interrupts();
  return run_rows(*args);
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-faults", argc, argv)) return 0;
  return handrail::end_output("handrail-faults", run({argv + 1, argv + argc}));
}
