// Rows of clocks that leap or differ.
#include <spdlog/fmt/fmt.h>

#include "server/base/clock.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

// Drives; nothing may be noticed.
void drive_unmoved(Trial& trial, std::unique_ptr<Bed> bed) {
  const bool full = trial.run().full;
  int bad = 0;
  double loop = 0.0;
  bed->drive(full ? 60 * kSecond : 6 * kSecond, [&](const pb::Status& s) {
    bad += s.state() == "fault" || s.slave_state() == "fault" ? 1 : 0;
    loop = std::max(loop, s.loop_age_ms());
  });
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.measure(fmt::format("{} gaps beside the machine's, loop age up to {:.1f} ms",
                            verdict.link.trips, loop));
  trial.check(bad == 0, "left the engagement");
  trial.check(verdict.link.trips == 0, "a gap");
}

}  // namespace

RowResult c1(const RowRun& run) {
  Trial trial(run, "the calendar leaps an hour ahead and back ten times a second, on both sides",
              "nothing is noticed");
  BedOptions options;
  options.master = options.slave = "env LD_PRELOAD=" LEAPING_CALENDAR;
  auto bed = trial.bed(options);
  if (!bed) return trial.result();
  drive_unmoved(trial, std::move(bed));
  return trial.result();
}

RowResult c2(const RowRun& run) {
  Trial trial(run, "the master's monotonic clock is 5000 s ahead", "nothing is noticed");
  constexpr const char* kAhead = "unshare -T --monotonic 5000 --boottime 5000 -f ";
  Child trying("/usr/bin/unshare", {"-T", "--monotonic", "5000", "-f", "true"}, "/dev/null");
  while (trying.running()) continue;
  if (trying.start_error() != 0 || trying.code() != 0) {
    trial.skip("unshare -T is refused here");
    return trial.result();
  }
  BedOptions options;
  options.master = kAhead;
  auto bed = trial.bed(options);
  if (!bed) return trial.result();
  const auto now = bed->status();
  const double ahead = now ? now->time_s() - to_seconds(monotonic_now()) : 0.0;
  trial.check(ahead > 4990.0, fmt::format("the master's clock is {:.0f} s ahead", ahead));
  drive_unmoved(trial, std::move(bed));
  return trial.result();
}

}  // namespace handrail::faults::rows
