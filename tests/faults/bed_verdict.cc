// How a bed ends, and what its judges say.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/faults/bed.h"

namespace handrail::faults {
namespace {

constexpr Nanos kEndPatience = 20 * kSecond;

// The number before `after` in the last words "link: N datagrams accepted, M rejected".
std::optional<std::uint64_t> said(const std::string& output, const std::string& after) {
  const std::size_t line = output.rfind("link: ");
  if (line == std::string::npos) return std::nullopt;
  const std::size_t end = output.find(after, line);
  if (end == std::string::npos) return std::nullopt;
  std::size_t from = end;
  while (from > 0 && output[from - 1] >= '0' && output[from - 1] <= '9') --from;
  return std::strtoull(output.c_str() + from, nullptr, 10);
}

}  // namespace

BedVerdict Bed::finish() {
  BedVerdict out;
  const auto report = emulator("report");
  if (report) out.report = *report;
  for (const Who who : {Who::kMaster, Who::kSlave, Who::kRig}) {
    const auto status = emulator("signal " + side_of(who) + " " + name_of(who) + " TERM");
    if (!status) problem(name_of(who) + " had ended by itself: " + printed(who));
    if (who == Who::kRig || !status) continue;
    // The slave's last words come after all that the master sent.
    const Nanos give_up = monotonic_now() + kEndPatience;
    while (!said(printed(who), " datagrams accepted") && monotonic_now() < give_up) {
      sleep_until(monotonic_now() + kMillisecond);
    }
  }
  (void)emulator("end");
  const Nanos give_up = monotonic_now() + kEndPatience;
  while (netfault_->running() && monotonic_now() < give_up) {
    sleep_until(monotonic_now() + kMillisecond);
  }
  const LatenessLog lateness = probe_.finish();
  out.accepted = said(printed(Who::kSlave), " datagrams accepted");
  out.rejected = said(printed(Who::kSlave), " rejected");
  out.violations = problems_;
  const auto add = [&](const storm::Violation& v) {
    out.violations.push_back(fmt::format("{:.3f} s: {}", to_seconds(v.at - start_), v.what));
  };
  const auto tap_file = handrail::read_tap(tap());
  const auto truth = read_truth(folder());
  if (!tap_file || !truth) {
    out.violations.push_back(!tap_file ? tap_file.message() : truth.message());
    return out;
  }
  out.truth = *truth;
  for (const FreshState& fresh : truth->to_slave) out.fresh += fresh.at >= slave_start_ ? 1 : 0;
  std::vector<storm::Violation> found;
  out.limits = storm::judge_tap(*tap_file, {}, found);
  out.link = judge_link(*tap_file, *truth, story_, lateness);
  found.insert(found.end(), out.link.violations.begin(), out.link.violations.end());
  std::stable_sort(
      found.begin(), found.end(),
      [](const storm::Violation& a, const storm::Violation& b) { return a.at < b.at; });
  for (const storm::Violation& v : found) add(v);
  return out;
}

}  // namespace handrail::faults
