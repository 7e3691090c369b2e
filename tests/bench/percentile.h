// Median, 99 %, 99.9 % and worst time of a call, beside Google Benchmark's mean, and the table of
// targets.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace handrail::bench {

// Time of one call [ns].
struct Summary {
  double median = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double worst = 0.0;
};

// Samples of the time of `calls_per_sample` calls each. One clock reading costs about as much as
// the fastest functions here, so that those are timed in batches: then the 99.9 % and the worst are
// of a batch's mean, and the benchmark's label says so.
class Samples {
 public:
  explicit Samples(int calls_per_sample = 1, std::size_t capacity = 1 << 20);

  // Times f() `calls_per_sample` times as one sample. f returns something to keep alive.
  template <typename F>
  void time(F&& f) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < calls_per_sample_; ++i) benchmark::DoNotOptimize(f());
    benchmark::ClobberMemory();
    const auto end = std::chrono::steady_clock::now();
    if (nanoseconds_.size() < nanoseconds_.capacity()) {
      nanoseconds_.push_back(static_cast<std::int32_t>((end - start).count()));
    }
  }

  int calls_per_sample() const { return calls_per_sample_; }
  // Per call, with the clock's own cost taken off.
  Summary summary() const;

 private:
  int calls_per_sample_;
  std::vector<std::int32_t> nanoseconds_;
};

// Median of two adjacent clock readings [ns], measured once.
double clock_cost_ns();

// Runs f for as long as Google Benchmark asks, then sets the counters median_ns, p99_ns, p999_ns,
// worst_ns and the label, and puts the summary under `name` for the table at the end. `target_ns`
// 0: none.
void record(benchmark::State& state, const std::string& name, const Samples& samples,
            double target_ns = 0.0);

template <typename F>
void run(benchmark::State& state, const std::string& name, int calls_per_sample, double target_ns,
         F&& f) {
  Samples samples(calls_per_sample);
  for (int i = 0; i < 200; ++i) benchmark::DoNotOptimize(f());
  for ([[maybe_unused]] auto _ : state) samples.time(f);
  state.SetItemsProcessed(state.iterations() * calls_per_sample);
  record(state, name, samples, target_ns);
}

// Puts what was measured under `name` in the table.
void put(const std::string& name, const Samples& samples, double target_ns = 0.0);
// A line below the table, of what was not measured and why.
void remark(const std::string& line);

// A further line for the table: `median` of `name` is to stay within `factor` times that of `peer`,
// both of this run. Lines whose names were not measured are left out.
void compare(const std::string& name, const std::string& peer, double factor);
// The same for the 99 % of both.
void compare_99(const std::string& name, const std::string& peer, double factor);
// The same for the 99.9 % of `name`, beside the peer's median.
void compare_late(const std::string& name, const std::string& peer, double factor);

// Machine, build and clock cost as context lines; then, after the run, the table. Used by main.
void add_context();
void print_table(std::FILE* out);

}  // namespace handrail::bench
