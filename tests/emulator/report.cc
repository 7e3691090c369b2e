#include "tests/emulator/report.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <utility>

namespace handrail::emulator {
namespace {

struct Row {
  const char* name;
  std::uint64_t Counts::*count;
};

constexpr std::array<Row, 11> kRows = {{
    {"sent", &Counts::sent},
    {"lost", &Counts::lost},
    {"dark", &Counts::dark},
    {"overflow", &Counts::overflow},
    {"nobodys", &Counts::nobodys},
    {"duplicated", &Counts::duplicated},
    {"replayed", &Counts::replayed},
    {"corrupted", &Counts::corrupted},
    {"injected", &Counts::injected},
    {"delivered", &Counts::delivered},
    {"ignored", &Counts::ignored},
}};

double in_us(Nanos span) { return to_seconds(span) * 1e6; }

std::string json_of(const Counts& counts) {
  std::string out;
  for (const Row& row : kRows) {
    out += fmt::format("{}\"{}\":{}", out.empty() ? "" : ",", row.name, counts.*row.count);
  }
  return "{" + out + "}";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

std::string for_people(const Report& report) {
  std::string out = fmt::format("seed {}, {:.1f} s\n{:12} {:>12} {:>12}\n", report.seed,
                                report.seconds, "packets", "to far", "to near");
  for (const Row& row : kRows) {
    out += fmt::format("{:12} {:12} {:12}\n", row.name, report.to_far.*row.count,
                       report.to_near.*row.count);
  }
  out += fmt::format("{:12} {:12} {:12}\n", "missed", report.missed_near, report.missed_far);
  out += fmt::format("delivered late p50 {:.0f} us, p99.9 {:.0f} us, worst {:.1f} ms ({})\n",
                     in_us(report.late_p50), in_us(report.late_p999),
                     in_us(report.late_worst) * 1e-3, report.timing);
  for (const Report::Program& program : report.programs) {
    out += fmt::format("{} {} (pid {}): {}\n", program.side, program.name, program.pid,
                       program.ending);
  }
  return out;
}

std::string to_json(const Report& report) {
  std::string programs;
  for (const Report::Program& program : report.programs) {
    programs += fmt::format(R"({}{{"side":"{}","name":{},"pid":{},"ending":{}}})",
                            programs.empty() ? "" : ",", program.side, quoted(program.name),
                            program.pid, quoted(program.ending));
  }
  return fmt::format(
      R"({{"seed":{},"seconds":{:.3f},"to_far":{},"to_near":{},"missed_near":{},"missed_far":{},)"
      R"("refused":{},"late_us":{{"p50":{:.1f},"p99.9":{:.1f},"worst":{:.1f}}},"timing":{},"programs":[{}]}})",
      report.seed, report.seconds, json_of(report.to_far), json_of(report.to_near),
      report.missed_near, report.missed_far, report.refused, in_us(report.late_p50),
      in_us(report.late_p999), in_us(report.late_worst), quoted(report.timing), programs);
}

}  // namespace handrail::emulator
