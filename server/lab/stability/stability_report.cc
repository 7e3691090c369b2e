#include "server/lab/stability/stability_report.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <map>
#include <utility>

namespace handrail {
namespace {

// Those that were refused are counted apart.
struct Count {
  int runs = 0, hold = 0;

  void add(const CaseRun& run) {
    runs += !run.refused();
    hold += run.holds();
  }
  std::string text() const {
    return runs == 0 ? std::string("-") : fmt::format("{} of {}", hold, runs);
  }
};

struct Family {
  Count must, may;
  int refused = 0;
};

// "net_mj 2.31 > 1"
std::string figure_text(const CaseFigure& f) {
  if (!f.judged) return fmt::format("{} {:.4g}", f.name, f.value);
  return fmt::format("{} {:.4g} {} {:.4g}", f.name, f.value, f.holds() ? "<=" : ">", f.most);
}

std::string run_text(const CaseRun& run, bool every) {
  if (run.refused()) return fmt::format("refused {}: {}\n", again(run), run.came_to.refused);
  std::string out = fmt::format(
      "{} {}:", !run.holds() ? (run.failed() ? "FAILS" : "unstable") : "holds", again(run));
  for (const CaseFigure& f : run.came_to.figures) {
    if (every || !f.holds()) out.append(fmt::format(" {};", figure_text(f)));
  }
  if (!run.came_to.note.empty()) out.append(fmt::format(" {};", run.came_to.note));
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
  std::map<std::string, Family> families;
  for (const CaseRun& run : runs) {
    const std::string name = run.of->family();
    if (families.count(name) == 0) order.push_back(name);
    Family& family = families[name];
    (run.of->must_hold ? family.must : family.may).add(run);
    family.refused += run.refused();
  }
  out = "| family | must hold, and do | need not, but do | refused |\n|---|---|---|---|\n";
  for (const std::string& name : order) {
    const Family& family = families[name];
    out.append(fmt::format("| {} | {} | {} | {} |\n", name, family.must.text(), family.may.text(),
                           family.refused > 0 ? fmt::to_string(family.refused) : "-"));
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
    if (run.refused()) out.append(fmt::format(", \"refused\": \"{}\"", run.came_to.refused));
    if (!run.came_to.note.empty()) {
      out.append(fmt::format(", \"note\": \"{}\"", run.came_to.note));
    }
    for (const CaseFigure& f : run.came_to.figures) {
      out.append(fmt::format(", \"{}\": {}", f.name, number(f.value)));
      if (f.judged) out.append(fmt::format(", \"{}_most\": {}", f.name, number(f.most)));
    }
    out.append("}\n");
  }
  return out;
}

}  // namespace handrail
