#include "server/lab/links/link_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>

#include "server/lab/console/console.h"
#include "server/lab/links/link_map.h"

namespace handrail {

int run_link_command(const LinkCommand& command, const std::atomic<bool>& cancelled) {
  LinkMapOptions options;
  if (!command.delays_ms.empty()) options.delays_ms = command.delays_ms;
  if (!command.jitters_ms.empty()) options.jitters_ms = command.jitters_ms;
  if (!command.losses.empty()) {
    options.losses = command.losses;
    for (double& loss : options.losses) loss /= 100.0;
  }
  const double longest = *std::max_element(options.delays_ms.begin(), options.delays_ms.end());
  const double least = *std::min_element(options.jitters_ms.begin(), options.jitters_ms.end());
  if (least > longest) {
    return complain(
        Status::error(fmt::format("--jitter {:g} is more than the longest --delay, {:g}; "
                                  "expected at most that: nothing comes before it was "
                                  "sent",
                                  least, longest)),
        kUsage);
  }
  options.in_order = command.in_order;
  options.seeds = command.seeds;
  options.threads = command.threads;
  options.cancelled = &cancelled;
  Progress progress;
  options.progress = [&](std::size_t done, std::size_t of) {
    progress.show(fmt::format("{} of {} runs", done, of));
  };
  const Nanos start = monotonic_now();
  const std::vector<LinkCell> cells = run_link_map(options);
  progress.clear();
  if (cells.empty()) return complain(Status::error("cancelled"), kCancelled);
  const auto runs = static_cast<double>(cells.size()) * options.seeds;
  const double took = to_seconds(monotonic_now() - start);
  std::fputs((command.json ? link_json(cells) : link_table(options, cells)).c_str(), stdout);
  std::fprintf(stderr, "%.0f runs in %.1f s\n", runs, took);
  std::uint64_t violations = 0;
  for (const LinkCell& cell : cells) violations += cell.figures.violations;
  if (violations == 0) return kDone;
  return complain(Status::error(fmt::format("the auditor found {} violations", violations)),
                  kFailed);
}

}  // namespace handrail
