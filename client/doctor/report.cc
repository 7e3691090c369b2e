#include "client/doctor/report.h"

#include <algorithm>

namespace handrail {
namespace {

constexpr std::size_t kWidth = 100, kIndent = 9;

const char* level_text(Level level) {
  return level == Level::kOk ? "ok" : level == Level::kNote ? "NOTE" : "PROBLEM";
}

std::size_t count_of(const Findings& findings, Level level) {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(),
                    [level](const Finding& finding) { return finding.level == level; }));
}

// The label, then the text, on as many rows as it needs; a word that is longer than a row stays
// whole.
void add_rows(std::string& out, const std::string& label, std::string rest) {
  std::string row = label;
  row.resize(std::max(row.size() + 1, kIndent), ' ');
  while (row.size() + rest.size() > kWidth) {
    std::size_t cut = rest.rfind(' ', kWidth - row.size());
    if (cut == std::string::npos || cut == 0) cut = rest.find(' ', 1);
    if (cut == std::string::npos) break;
    out += row + rest.substr(0, cut) + '\n';
    rest = rest.substr(cut + 1);
    row.assign(kIndent, ' ');
  }
  out += row + rest + '\n';
}

std::string plural(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

std::string doctor_text(const Findings& findings) {
  std::string out;
  for (const Finding& finding : findings) {
    add_rows(out, level_text(finding.level), finding.check + ": " + finding.fact);
    // On a line of its own and whole: it is to be copied.
    if (!finding.next.empty()) out += std::string(kIndent, ' ') + "-> " + finding.next + '\n';
  }
  return out + plural(count_of(findings, Level::kProblem), "problem") + ", " +
         plural(count_of(findings, Level::kNote), "note") + '\n';
}

pb::DoctorReport doctor_report(const Findings& findings) {
  pb::DoctorReport out;
  out.set_problems(static_cast<std::uint32_t>(count_of(findings, Level::kProblem)));
  out.set_notes(static_cast<std::uint32_t>(count_of(findings, Level::kNote)));
  for (const Finding& finding : findings) {
    pb::DoctorFinding* one = out.add_findings();
    one->set_check(finding.check);
    one->set_level(static_cast<pb::DoctorFinding::Level>(finding.level));
    one->set_fact(finding.fact);
    one->set_next(finding.next);
  }
  return out;
}

}  // namespace handrail
