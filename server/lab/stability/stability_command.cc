#include "server/lab/stability/stability_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "server/base/plain_text.h"
#include "server/lab/console/console.h"
#include "server/lab/stability/stability_map.h"
#include "server/lab/stability/stability_report.h"
#include "server/lab/stability/teleop_map.h"
#include "server/lab/study/parallel.h"
#include "server/lab/study/study_drawing.h"

namespace handrail {
namespace {

constexpr int kSeeds = 20;  // of a full run

bool begins_with(const std::string& name, const std::string& only) {
  return name.compare(0, only.size(), only) == 0 &&
         (name.size() == only.size() || only.empty() || only.back() == '/' ||
          name[only.size()] == '/');
}

std::vector<StabilityCase> chosen(const StabilityCommand& command,
                                  const std::atomic<bool>* cancelled = nullptr) {
  std::vector<StabilityCase> out = long_cases(cancelled);
  for (auto* cases : {&teleop_cases, &arm_cases, &truth_cases, &rendered_cases, &wall_cases,
                      &guidance_cases, &turn_cases}) {
    for (StabilityCase& one : cases()) out.push_back(std::move(one));
  }
  std::erase_if(out, [&](const StabilityCase& one) {
    return (command.quick && one.size >= CaseSize::kFull) || !begins_with(one.name, command.only);
  });
  return out;
}

// What is wrong with the name, and what there is instead.
Status unknown(const std::string& only) {
  const std::string asked = shown(only);
  if (!chosen({.only = only}).empty()) {
    return Status::error(
        fmt::format("--case '{}': only without --quick, which leaves it out", asked));
  }
  std::vector<std::string> names, families;
  for (const StabilityCase& one : chosen({})) {
    names.push_back(one.name);
    if (families.empty() || families.back() != one.family()) families.push_back(one.family());
  }
  const std::string nearest = nearest_name(only, names);
  std::string known;
  for (const std::string& family : families) known.append((known.empty() ? "" : ", ") + family);
  return Status::error(fmt::format(
      "--case '{}': no case begins so; {}", asked,
      nearest.empty() ? "expected one of --list, or the first parts of its name: " + known
                      : "did you mean '" + nearest + "'?"));
}

std::vector<CaseRun> runs_of(const std::vector<StabilityCase>& cases,
                             const StabilityCommand& command) {
  std::vector<CaseRun> runs;
  for (const StabilityCase& one : cases) {
    const bool small = one.size == CaseSize::kSmall && !command.quick && command.only.empty();
    const int many = command.seeds > 0 ? command.seeds : small ? kSeeds : 1;
    const int seeds = one.size == CaseSize::kDay ? 1 : many;
    for (int i = 0; i < (one.drawn ? seeds : 1); ++i) {
      runs.push_back({&one, command.seed + static_cast<std::uint64_t>(i), {}});
    }
  }
  return runs;
}

// All that --figures draws; `table`: of delay and loss.
Result<bool> draw_maps(const StabilityCommand& command, const std::atomic<bool>& cancelled,
                       Progress& progress, std::string& table) {
  StabilityMapOptions map;
  map.threads = command.threads;
  map.cancelled = &cancelled;
  map.progress = [&](std::size_t n, std::size_t of) {
    progress.show(fmt::format("figure: {} of {} runs", n, of));
  };
  Result<bool> drawn = draw_stability_maps(command.figures, map);
  if (!drawn || !*drawn) return drawn;
  return draw_teleop_map(command.figures, map, table);
}

}  // namespace

int run_stability_command(const StabilityCommand& command, const std::atomic<bool>& cancelled) {
  const std::vector<StabilityCase> cases = chosen(command, &cancelled);
  if (cases.empty()) return complain(unknown(command.only), kUsage);
  if (command.list) {
    for (const StabilityCase& one : cases) std::printf("%s\n", one.name.c_str());
    return kDone;
  }
  if (!command.figures.empty()) {
    if (Status s = make_folder(command.figures); !s) return complain(s, kFailed);
  }
  std::vector<CaseRun> runs = runs_of(cases, command);
  Progress progress;
  const Nanos start = monotonic_now();
  const bool done = run_parallel(
      runs.size(), command.threads,
      [&](std::size_t i) { runs[i].came_to = runs[i].of->run(runs[i].seed); },
      [&](std::size_t n) { progress.show(fmt::format("{} of {} runs", n, runs.size())); },
      &cancelled);
  progress.clear();
  // A run of a day that was cut short is no result, though all have run.
  if (!done || cancelled.load()) return complain(Status::error("cancelled"), kCancelled);
  std::string map;
  if (!command.figures.empty()) {
    const Result<bool> drawn = draw_maps(command, cancelled, progress, map);
    progress.clear();
    if (!drawn) return complain(drawn.status(), kFailed);
    if (!*drawn) return complain(Status::error("cancelled"), kCancelled);
  }
  const double took = to_seconds(monotonic_now() - start);
  const bool every = !command.only.empty();
  std::fputs((command.json ? stability_json(runs) : stability_table(runs, every)).c_str(), stdout);
  if (!command.json && !map.empty()) std::printf("\n%s", map.c_str());
  std::fprintf(stderr, "%zu runs in %.1f s\n", runs.size(), took);
  const auto failed =
      std::count_if(runs.begin(), runs.end(), [](const CaseRun& run) { return run.failed(); });
  if (failed == 0) return kDone;
  return complain(
      Status::error(fmt::format("{} of {} runs do not hold what they must", failed, runs.size())),
      kFailed);
}

}  // namespace handrail
