// A day, and the ends of counters.
#include <spdlog/fmt/fmt.h>

#include "server/lab/stability/long_run.h"

namespace handrail {
namespace {

constexpr double kDay = 86'400.0;            // [s]
constexpr std::uint64_t kSoon = 3000;        // datagrams before an end: within the first round
constexpr Nanos kOf53Bits = Nanos{1} << 53;  // beyond it a double has no nanoseconds
// 292 years less four, as much as is promised for ages
constexpr Nanos kLate = kForever - 3600 * kSecond;

}  // namespace

std::vector<StabilityCase> long_cases(const std::atomic<bool>* cancelled) {
  std::vector<StabilityCase> out;
  const auto add = [&out](const std::string& name, CaseSize size,
                          std::function<CaseOutcome(std::uint64_t)> run, bool drawn = false) {
    out.push_back({"long-run/" + name, true, drawn, std::move(run), size});
  };
  for (const bool surface : {false, true}) {
    const std::string where = surface ? "contact" : "free";
    const LongRun day{.surface = surface, .cancelled = cancelled};
    const LongRun minutes{.parts = 12, .part = 10.0, .surface = surface};
    add(
        where + "/24h", CaseSize::kDay, [day](std::uint64_t seed) { return run_long(day, seed); },
        true);
    add(
        where + "/2min", CaseSize::kLarge,
        [minutes](std::uint64_t seed) { return run_long(minutes, seed); }, true);
  }
  add("turns/24h", CaseSize::kDay,
      [cancelled](std::uint64_t) { return run_turns(kDay, cancelled); });
  add("turns/10min", CaseSize::kLarge, [](std::uint64_t) { return run_turns(600.0); });
  const auto counters = [&add](const std::string& name, const LoopCounters& of) {
    add("counters/" + name, CaseSize::kLarge, [of](std::uint64_t) { return run_counters(of); });
  };
  counters("sequence-2^32", {.sequence = (std::uint64_t{1} << 32) - kSoon, .epoch = 1000});
  counters("sequence-2^53", {.sequence = (std::uint64_t{1} << 53) - kSoon, .epoch = 1000});
  counters("sequence-2^63", {.sequence = (std::uint64_t{1} << 63) - kSoon, .epoch = 1000});
  counters("epoch-2^32", {.epoch = (std::uint64_t{1} << 32) - 3});
  counters("epoch-2^64", {.epoch = ~std::uint64_t{0} - 2});
  counters("clock-2^53", {.clock = kOf53Bits - kSecond, .epoch = 1000});
  counters("clock-late", {.clock = kLate, .epoch = 1000});
  add("counters/last-datagram", CaseSize::kLarge,
      [](std::uint64_t) { return run_last_datagram(); });
  return out;
}

}  // namespace handrail
