#include "tests/bench/percentile.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

namespace handrail::bench {
namespace {

struct Line {
  Summary summary;
  int calls_per_sample = 1;
  double target_ns = 0.0;
};

struct Comparison {
  std::string name;
  std::string peer;
  double factor = 1.0;
  double Summary::*ours = &Summary::median;
  double Summary::*peers = &Summary::median;
  const char* what = "";
};

// Filled by the benchmarks, in this thread; a benchmark runs several times and the last one counts.
std::map<std::string, Line>& lines() {
  static std::map<std::string, Line> all;
  return all;
}

std::vector<Comparison>& comparisons() {
  static std::vector<Comparison> all;
  return all;
}

std::vector<std::string>& remarks() {
  static std::vector<std::string> all;
  return all;
}

double at_share(std::vector<std::int32_t>& values, double share) {
  const double last = static_cast<double>(values.size() - 1);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::ceil(share * last));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "unknown processor";
}

const char* verdict(double value, double limit) { return value <= limit ? "within" : "over"; }

}  // namespace

double clock_cost_ns() {
  static const double cost = [] {
    std::vector<std::int32_t> gaps(100'000);
    for (std::int32_t& gap : gaps) {
      const auto start = std::chrono::steady_clock::now();
      const auto end = std::chrono::steady_clock::now();
      gap = static_cast<std::int32_t>((end - start).count());
    }
    return at_share(gaps, 0.5);
  }();
  return cost;
}

Samples::Samples(int calls_per_sample, std::size_t capacity) : calls_per_sample_(calls_per_sample) {
  nanoseconds_.reserve(capacity);
}

Summary Samples::summary() const {
  if (nanoseconds_.empty()) return {};
  std::vector<std::int32_t> values = nanoseconds_;
  const auto per_call = [this](double ns) {
    return std::max(0.0, ns - clock_cost_ns()) / calls_per_sample_;
  };
  return {per_call(at_share(values, 0.5)), per_call(at_share(values, 0.99)),
          per_call(at_share(values, 0.999)), per_call(at_share(values, 1.0))};
}

void record(benchmark::State& state, const std::string& name, const Samples& samples,
            double target_ns) {
  const Summary s = samples.summary();
  state.counters["median_ns"] = s.median;
  state.counters["p99_ns"] = s.p99;
  state.counters["p999_ns"] = s.p999;
  state.counters["worst_ns"] = s.worst;
  const int calls = samples.calls_per_sample();
  state.SetLabel(calls == 1 ? "each call timed"
                            : "percentiles of the mean of " + std::to_string(calls) + " calls");
  put(name, samples, target_ns);
}

void put(const std::string& name, const Samples& samples, double target_ns) {
  lines()[name] = {samples.summary(), samples.calls_per_sample(), target_ns};
}

void remark(const std::string& line) { remarks().push_back(line); }

void compare(const std::string& name, const std::string& peer, double factor) {
  comparisons().push_back({name, peer, factor});
}

void compare_99(const std::string& name, const std::string& peer, double factor) {
  comparisons().push_back({name, peer, factor, &Summary::p99, &Summary::p99, " 99 %"});
}

void compare_late(const std::string& name, const std::string& peer, double factor) {
  comparisons().push_back({name, peer, factor, &Summary::p999, &Summary::median, " 99.9 %"});
}

void add_context() {
  utsname host{};
  uname(&host);
  benchmark::AddCustomContext("machine", std::string(host.nodename) + ", " + cpu_name() + ", " +
                                             host.sysname + " " + host.release);
  benchmark::AddCustomContext("build", HANDRAIL_BUILD_FLAGS);
  char cost[32];
  std::snprintf(cost, sizeof cost, "%.0f ns, subtracted", clock_cost_ns());
  benchmark::AddCustomContext("clock_reading", cost);
}

void print_table(std::FILE* out) {
  std::fprintf(out, "\n%-34s %6s %10s %10s %10s %10s  %s\n", "time per call [ns]", "batch",
               "median", "99 %", "99.9 %", "worst", "target for the median");
  for (const auto& [name, line] : lines()) {
    std::fprintf(out, "%-34s %6d %10.1f %10.1f %10.1f %10.1f", name.c_str(), line.calls_per_sample,
                 line.summary.median, line.summary.p99, line.summary.p999, line.summary.worst);
    if (line.target_ns > 0.0) {
      std::fprintf(out, "  <= %.0f: %s", line.target_ns,
                   verdict(line.summary.median, line.target_ns));
    }
    std::fputc('\n', out);
  }
  for (const Comparison& c : comparisons()) {
    const auto ours = lines().find(c.name), peer = lines().find(c.peer);
    if (ours == lines().end() || peer == lines().end()) continue;
    const double ratio = ours->second.summary.*c.ours / (peer->second.summary.*c.peers);
    std::fprintf(out, "%s%s / %s = %.3f  <= %.3f: %s\n", c.name.c_str(), c.what, c.peer.c_str(),
                 ratio, c.factor, verdict(ratio, c.factor));
  }
  for (const std::string& line : remarks()) std::fprintf(out, "%s\n", line.c_str());
}

}  // namespace handrail::bench
