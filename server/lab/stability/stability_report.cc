#include "server/lab/stability/stability_report.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <map>
#include <utility>

namespace handrail {
namespace {

struct Count {
  int runs = 0, hold = 0;

  std::string text() const {
    return runs == 0 ? std::string("-") : fmt::format("{} of {}", hold, runs);
  }
};

// "net_mj 2.31 > 1"
std::string figure_text(const CaseFigure& f) {
  if (!f.judged) return fmt::format("{} {:.4g}", f.name, f.value);
  return fmt::format("{} {:.4g} {} {:.4g}", f.name, f.value, f.holds() ? "<=" : ">", f.most);
}

std::string run_text(const CaseRun& run, bool every) {
  std::string out = fmt::format(
      "{} {}:", !run.holds() ? (run.failed() ? "FAILS" : "unstable") : "holds", again(run));
  for (const CaseFigure& f : run.figures) {
    if (every || !f.holds()) out.append(fmt::format(" {};", figure_text(f)));
  }
  out.back() = '\n';
  return out;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string("null");
}

}  // namespace

std::string again(const CaseRun& run) {
  std::string out = "--case " + run.of->name;
  if (run.of->drawn) out.append(fmt::format(" --seed {}", run.seed));
  return out;
}

std::string stability_table(const std::vector<CaseRun>& runs, bool every) {
  std::string out;
  if (every) {
    for (const CaseRun& run : runs) out.append(run_text(run, true));
    return out;
  }
  std::vector<std::string> order;
  std::map<std::string, std::pair<Count, Count>> families;
  for (const CaseRun& run : runs) {
    const std::string family = run.of->family();
    if (families.count(family) == 0) order.push_back(family);
    Count& count = run.of->must_hold ? families[family].first : families[family].second;
    ++count.runs;
    count.hold += run.holds();
  }
  out = "| family | must hold, and do | need not, but do |\n|---|---|---|\n";
  for (const std::string& family : order) {
    const auto& [must, may] = families[family];
    out.append(fmt::format("| {} | {} | {} |\n", family, must.text(), may.text()));
  }
  for (const CaseRun& run : runs) {
    if (run.failed()) out.append(run_text(run, false));
  }
  return out;
}

std::string stability_json(const std::vector<CaseRun>& runs) {
  std::string out;
  for (const CaseRun& run : runs) {
    out.append(fmt::format("{{\"case\": \"{}\", \"seed\": {}, \"must_hold\": {}, \"holds\": {}",
                           run.of->name, run.seed, run.of->must_hold, run.holds()));
    for (const CaseFigure& f : run.figures) {
      out.append(fmt::format(", \"{}\": {}", f.name, number(f.value)));
      if (f.judged) out.append(fmt::format(", \"{}_most\": {}", f.name, number(f.most)));
    }
    out.append("}\n");
  }
  return out;
}

}  // namespace handrail
