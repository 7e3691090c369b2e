// handrail-bench: Google Benchmark with its own flags (--benchmark_filter=..., --benchmark_format=
// json, ...; --json is short for the latter), then a table of percentiles and targets. In a machine
// format the table goes to the standard error.
#include <cstring>
#include <string>
#include <vector>

#include "server/base/version.h"
#include "tests/bench/percentile.h"

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-bench", argc, argv)) return 0;
  static char json[] = "--benchmark_format=json";
  std::vector<char*> args(argv, argv + argc);
  bool machine_format = false;
  for (char*& arg : args) {
    if (std::strcmp(arg, "--json") == 0) arg = json;
    const std::string text = arg;
    machine_format |= text == json || text == "--benchmark_format=csv";
  }
  int count = static_cast<int>(args.size());
  args.push_back(nullptr);
  benchmark::Initialize(&count, args.data());
  if (benchmark::ReportUnrecognizedArguments(count, args.data())) return 2;
  handrail::bench::add_context();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  handrail::bench::print_table(machine_format ? stderr : stdout);
  return 0;
}
