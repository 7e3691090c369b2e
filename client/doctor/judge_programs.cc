#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

constexpr char kSameOnBoth[] =
    "install the same Handrail on both computers, and start master and slave anew";

// "process 4711", "processes 4711, 4712" of that name; empty: none runs.
std::string processes(const DoctorFacts& facts, const char* name) {
  std::string out;
  int count = 0;
  for (const LocalProgram& program : facts.programs) {
    if (program.name != name) continue;
    out += (count++ == 0 ? "" : ", ") + std::to_string(program.process);
  }
  return out.empty() ? out : (count == 1 ? "process " : "processes ") + out;
}

Finding running_master(const DoctorFacts& facts, const std::string& slaves) {
  const char* const check = "programs.master";
  if (facts.master.status) {
    return {check, Level::kOk,
            facts.master.place.host.empty() ? "a master answers on " + facts.master.place.socket
                                            : "a master answers at " + facts.master.place.host,
            ""};
  }
  if (!facts.master.place.host.empty()) {
    return {check, Level::kProblem, facts.master.problem, "handrail doctor, on that computer"};
  }
  if (!facts.master.absent) {
    return {check, Level::kProblem, facts.master.problem,
            "end that master, and start it anew; its log may say more"};
  }
  const std::string masters = processes(facts, "handrail-master");
  if (!masters.empty()) {
    return {check, Level::kNote,
            "a master of this user runs here (" + masters + "), but not on this socket (" +
                facts.master.problem + ")",
            "handrail doctor --socket PATH, with the operator_socket of its configuration"};
  }
  if (!slaves.empty()) {
    return {check, Level::kNote,
            "a slave runs here and no master: this is the arm's computer. What the link does is "
            "seen at the master, and who was refused in the slave's log",
            "handrail doctor, on the master's computer"};
  }
  return {check, Level::kNote,
          "neither a master nor a slave of this user runs here (" + facts.master.problem +
              "): the link cannot be looked at",
          "handrail-master --link THE-ARM'S-HOST; on the arm's computer handrail-slave --link any; "
          "both without --link on one computer"};
}

void judge_running(const DoctorFacts& facts, Findings& out) {
  const std::string slaves = processes(facts, "handrail-slave");
  out.push_back(running_master(facts, slaves));
  if (slaves.empty()) return;
  out.push_back(
      {"programs.slave", Level::kOk, "a slave of this user runs here (" + slaves + ")", ""});
}

struct Version {
  std::string whose, text;
};

void compare(const char* check, const Version& a, const Version& b, const std::string& next,
             Findings& out) {
  if (a.text == b.text) {
    out.push_back(
        {check, Level::kOk, a.whose + " and " + b.whose + " are of version " + a.text, ""});
  } else {
    out.push_back({check, Level::kNote,
                   a.whose + " is of version " + a.text + ", " + b.whose + " of " + b.text, next});
  }
}

std::string version_of(const pb::ProgramStatus& program) {
  if (!program.has_version()) return "one that is too old to say";
  return formatted("%s (wire version %u)", program.version().c_str(), program.wire_version());
}

}  // namespace

void judge_programs(const DoctorFacts& facts, Findings& out) {
  judge_running(facts, out);
  const Version own = {
      "this program", formatted("%s (wire version %d)", facts.version.c_str(), facts.wire_version)};
  if (!facts.master.status) {
    out.push_back({"programs.version", Level::kOk, "this program is of version " + own.text, ""});
    return;
  }
  const pb::Status& status = status_of(facts);
  const Version master = {"the master", version_of(status.program())};
  compare("programs.version", own, master,
          "start the master anew, with the program that stands beside this one", out);
  if (!status.has_slave_program()) return;
  const pb::ProgramStatus& slave = status.slave_program();
  if (slave.wire_version() == status.program().wire_version()) {
    return compare("programs.slave_version", master, {"the slave", version_of(slave)}, kSameOnBoth,
                   out);
  }
  out.push_back(
      {"programs.slave_version", Level::kProblem,
       formatted("the slave speaks wire version %u, the master %u: neither obeys the other",
                 slave.wire_version(), status.program().wire_version()),
       kSameOnBoth});
}

}  // namespace handrail
