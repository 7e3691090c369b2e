#include <algorithm>
#include <cmath>
#include <ctime>

#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

// Two calendars that are further apart make two logs that cannot be read side by side, and that
// far that somebody should set one. Nothing is decided by a calendar.
constexpr double kCalendarsApart = 2.0, kCalendarsFarApart = 3600.0;  // [s]
// Of one processor, to the hypervisor: over it a haptic loop of 1 kHz misses ticks of its own every
// second (1 % of 1000).
constexpr double kMuchStolen = 0.01;

std::string calendar_text(double since_1970) {
  const auto seconds = static_cast<std::time_t>(since_1970);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  (void)std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return text.data();
}

// Programs go on without it, and with a simulated device nobody is hurt by it.
Level lacks_realtime(const DoctorFacts& facts) {
  const bool real_device = facts.master.status && !status_of(facts).device_simulated();
  return real_device ? Level::kProblem : Level::kNote;
}

std::string granted_text(const pb::ProgramStatus& program, const char* thread) {
  const auto fifo = [](bool has) { return has ? "in real time" : "NOT in real time"; };
  return std::string(thread) + " thread " + fifo(program.control_fifo()) + ", IO thread " +
         fifo(program.io_fifo()) + ", memory " +
         (program.memory_locked() ? "locked" : "NOT locked");
}

bool has_all(const pb::ProgramStatus& program) {
  return program.control_fifo() && program.io_fifo() && program.memory_locked();
}

void judge_daemon(const DoctorFacts& facts, const char* check, const std::string& fact, bool all,
                  bool here, Findings& out) {
  const bool may = facts.machine.may_fifo && facts.machine.may_lock;
  const std::string next = !here ? "on the slave's computer: handrail doctor"
                           : may ? "end it, and start it anew from this shell, which may"
                                 : facts.realtime_line;
  out.push_back({check, all ? Level::kOk : lacks_realtime(facts), fact, all ? "" : next});
}

// Of those that run here and tell nobody, what can be seen from outside.
void judge_local(const DoctorFacts& facts, const char* check, const char* name, Findings& out) {
  constexpr int kThreads = 2;  // control and IO
  for (const LocalProgram& program : facts.programs) {
    if (program.name != name) continue;
    judge_daemon(
        facts, check,
        formatted("%s (process %d): %d threads with SCHED_FIFO, expected at least %d; memory %s",
                  name, program.process, program.fifo_threads, kThreads,
                  program.memory_locked ? "locked" : "NOT locked"),
        program.fifo_threads >= kThreads && program.memory_locked, true, out);
  }
}

std::string limit_text(long value, const char* unit) {
  return value < 0 ? "unlimited" : formatted("%ld%s", value, unit);
}

void judge_calendars(const DoctorFacts& facts, Findings& out) {
  const pb::Status& s = status_of(facts);
  if (slave_is_heard(s) && s.program().has_calendar_s()) {
    const double ours = s.program().calendar_s(), theirs = s.slave_program().calendar_s();
    const double apart = std::abs(ours - theirs);
    const std::string fact = "the calendar here says " + calendar_text(ours) +
                             ", the slave's computer " + calendar_text(theirs) +
                             formatted(": %.1f s apart", apart);
    const Level level = apart > kCalendarsFarApart ? Level::kProblem
                        : apart > kCalendarsApart  ? Level::kNote
                                                   : Level::kOk;
    out.push_back(
        {"clock.calendar", level,
         fact + (level == Level::kOk ? "" : "; logs cannot be read side by side"),
         level == Level::kOk ? "" : "timedatectl set-ntp true   as root, on both computers"});
  }
  if (!facts.machine.calendar_is_kept || *facts.machine.calendar_is_kept) return;
  out.push_back(
      {"clock.kept", Level::kNote,
       "no time server keeps this computer's calendar; the link does not need one, logs do",
       "timedatectl set-ntp true   as root"});
}

void judge_clock_source(const MachineFacts& machine, Findings& out) {
  if (machine.clock_source.empty()) return;
  // Read through a device: a microsecond or more for each look at the clock.
  bool slow = false;
  for (const char* name : {"hpet", "acpi_pm", "jiffies", "refined-jiffies", "pit"}) {
    slow = slow || machine.clock_source == name;
  }
  out.push_back({"clock.source", slow ? Level::kNote : Level::kOk,
                 "the kernel's clock is " + machine.clock_source +
                     (slow ? ", which is slow to read; expected tsc, or the hypervisor's" : ""),
                 slow ? "look in `dmesg` for why tsc was marked unstable" : ""});
}

}  // namespace

void judge_realtime(const DoctorFacts& facts, Findings& out) {
  const MachineFacts& m = facts.machine;
  const bool may = m.may_fifo && m.may_lock;
  out.push_back({"realtime.shell", may ? Level::kOk : Level::kNote,
                 std::string("what this shell starts ") + (m.may_fifo ? "may" : "may NOT") +
                     " run in real time (ulimit -r: " + limit_text(m.most_priority, "") +
                     "), and " + (m.may_lock ? "may" : "may NOT") +
                     " lock its memory (ulimit -l: " + limit_text(m.most_locked_kb, " kB") + ")",
                 may ? "" : facts.realtime_line});
  const pb::Status& s = status_of(facts);
  if (s.program().has_control_fifo()) {
    judge_daemon(facts, "realtime.master", "master: " + granted_text(s.program(), "haptic"),
                 has_all(s.program()), true, out);
  } else {
    judge_local(facts, "realtime.master", "handrail-master", out);
  }
  if (slave_is_heard(s)) {
    judge_daemon(facts, "realtime.slave", "slave: " + granted_text(s.slave_program(), "robot"),
                 has_all(s.slave_program()), !s.peer().encrypted(), out);
  } else {
    judge_local(facts, "realtime.slave", "handrail-slave", out);
  }
}

void judge_machine(const DoctorFacts& facts, Findings& out) {
  const MachineFacts& m = facts.machine;
  if (!m.governors.empty()) {
    std::string all;
    for (const std::string& name : m.governors) all += (all.empty() ? "" : ", ") + name;
    const bool fast = all == "performance";
    out.push_back({"machine.governor", fast ? Level::kOk : Level::kNote,
                   "the processors' governor is " + all + (fast ? "" : ", expected performance"),
                   fast ? "" : "cpupower frequency-set -g performance   as root"});
  }
  if (m.watched_s > 0.0) {
    const bool stolen = m.stolen_share > kMuchStolen;
    std::string fact = m.stolen_share < 0.0
                           ? std::string()
                           : formatted("%.1f %% of a processor stolen by the hypervisor; ",
                                       100.0 * m.stolen_share);
    fact += m.pauses == 0 ? "no pause of 20 ms or more"
                          : formatted("%d pauses of 20 ms or more, the longest %.0f ms", m.pauses,
                                      m.longest_pause_ms);
    out.push_back({"machine.time", stolen || m.pauses > 0 ? Level::kNote : Level::kOk,
                   fact + formatted(", in %.1f s", m.watched_s),
                   stolen || m.pauses > 0
                       ? "end what else loads this computer, or move to one that "
                         "others do not share"
                       : ""});
  }
  judge_calendars(facts, out);
  judge_clock_source(m, out);
}

Findings judge(const DoctorFacts& facts) {
  Findings out;
  judge_keys(facts, out);
  judge_programs(facts, out);
  judge_link(facts, out);
  judge_route(facts, out);
  judge_session(facts, out);
  judge_devices(facts, out);
  judge_realtime(facts, out);
  judge_machine(facts, out);
  return out;
}

}  // namespace handrail
