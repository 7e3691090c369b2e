#include "client/cli/robot/robot_run.h"

#include <charconv>
#include <ostream>
#include <vector>

#include "devices/config/device_config_io.h"
#include "devices/melfa/r3_socket.h"
#include "proto/devices.pb.h"
#include "server/base/plain_text.h"
#include "server/model/reason.h"
#include "server/scene/config_io.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

constexpr Nanos kMasterPatience = kSecond;

const char* order_name(RobotOrder order) {
  switch (order) {
    case RobotOrder::kOn: return "on";
    case RobotOrder::kOff: return "off";
    case RobotOrder::kReset: return "reset";
    case RobotOrder::kStatus: return "status";
  }
  return "?";
}

// What the slave says of a stop, by way of the master.
struct SlaveView {
  std::string stop;  // empty: it holds none
  std::string note;  // why nobody could say; empty: somebody did
};

SlaveView slave_view(const RobotPlace& place) {
  pb::Request ask;
  ask.set_status(true);
  const auto reply =
      OperatorClient(place.master, place.as, place.interrupted).call(ask, kMasterPatience);
  if (!reply || !reply->has_status()) {
    return {"", "no master said whether the slave holds a stop"};
  }
  const pb::Status& s = reply->status();
  if (s.slave_state() == "none") return {"", "the master hears no slave that could hold a stop"};
  for (const Reason stop : {Reason::kStopRequested, Reason::kStopInput}) {
    if (s.slave_reason() == describe(stop)) return {s.slave_reason(), ""};
  }
  return {};
}

void tell(const R3State& state, const std::string& alarm_text, pb::RobotSwitches& out) {
  const R3Status& s = state.status;
  out.set_servo_on(s.servo_on());
  out.set_teach(s.teach());
  out.set_emergency_stop(s.emergency_stop());
  out.set_machine_lock(s.machine_lock());
  out.set_rights_taken(s.rights_taken());
  out.set_running(s.running());
  out.set_program(shown(state.program));
  out.set_line(static_cast<std::uint32_t>(state.line));
  out.set_override_percent(static_cast<std::uint32_t>(state.override_percent));
  out.set_alarm(static_cast<std::uint32_t>(s.alarm));
  out.set_alarm_text(alarm_text);
}

std::string switches_text(const pb::RobotSwitches& s) {
  std::string out = s.emergency_stop() ? "EMERGENCY STOP, " : "";
  out += s.teach() ? "TEACH" : "automatic";
  out += s.servo_on() ? ", servos on" : ", servos OFF";
  if (s.machine_lock()) out += ", MACHINE LOCK";
  out += s.program().empty() ? ", no program" : ", program '" + s.program() + "'";
  out += s.running() ? " runs at line " + std::to_string(s.line()) : " stands";
  out += ", override " + std::to_string(s.override_percent()) + " %";
  if (s.alarm() == 0)
    return out + ", no alarm" + (s.rights_taken() ? ", operated by somebody" : "");
  out += ", ALARM " + std::to_string(s.alarm());
  if (!s.alarm_text().empty()) out += " (" + s.alarm_text() + ')';
  return out + (s.rights_taken() ? ", operated by somebody" : "");
}

std::string report_text(const pb::RobotReport& report) {
  std::string out;
  if (report.has_before()) {
    out += report.place() + ": " + switches_text(report.before()) + '\n';
  }
  for (const std::string& step : report.steps()) out += "  " + step + '\n';
  if (report.has_after()) out += "now: " + switches_text(report.after()) + '\n';
  if (report.done() && report.steps().empty() && report.order() != "status") {
    out += "there was nothing to do\n";
  }
  if (report.ready()) out += "ready for real-time control, as far as its switches tell\n";
  if (!report.note().empty()) out += "note: " + report.note() + '\n';
  return out;
}

std::string complaint_text(const pb::RobotReport& report) {
  if (report.problem().empty()) return {};
  const bool told = report.order() == "status" && report.done();
  std::string out = told ? "not ready: " : "handrail: robot " + report.order() + ": ";
  out += report.problem() + '\n';
  return report.next().empty() ? out : out + "  -> " + report.next() + '\n';
}

void add(const SwitchesReport& from, const SwitchWishes& wishes, pb::RobotReport& out) {
  out.set_done(from.done);
  if (from.before) tell(*from.before, from.alarm_text, *out.mutable_before());
  if (from.after) tell(*from.after, "", *out.mutable_after());
  for (const std::string& step : from.steps) out.add_steps(step);
  out.set_problem(from.problem.fact);
  out.set_next(from.problem.next);
  const auto& last = from.after ? from.after : from.before;
  out.set_ready(last && obstacle_of(*last, wishes, "").none());
}

SwitchesReport carry_out(RobotOrder order, R3Line& line, const SwitchWishes& wishes) {
  switch (order) {
    case RobotOrder::kOn: return switch_on(line, wishes);
    case RobotOrder::kOff: return switch_off(line);
    case RobotOrder::kReset: return reset_alarm(line);
    case RobotOrder::kStatus: break;
  }
  return look_at_switches(line, wishes);
}

ExitCode end_with(const pb::RobotReport& report, const RobotWords& words, const RobotPlace& place) {
  if (words.json) {
    place.out << json_text(report, true) << '\n';
  } else {
    place.out << report_text(report) << std::flush;
    (words.order == RobotOrder::kStatus && report.done() ? place.out : place.err)
        << complaint_text(report);
  }
  if (report.done()) return kExitDone;
  return place.interrupted() && words.order != RobotOrder::kOff ? kExitInterrupted : kExitRefused;
}

// Of --override.
Result<int> percent_of(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && value >= 1 && value <= 100) {
    return value;
  }
  return Status::error("robot: --override '" + shown(text) + "', expected 1 to 100");
}

}  // namespace

ExitCode run_robot_order(const RobotWords& words, const RobotPlace& place) {
  const auto wrong = [&place](const std::string& text) {
    place.err << "handrail: " << text << '\n';
    return kExitUsage;
  };
  const auto config = load_slave_config(words.slave_config);
  if (!config) return wrong(config.message());
  const MelfaOptions options = robot_options(config->robot());
  SwitchWishes wishes{options.program, std::nullopt};
  if (words.override_text) {
    const auto percent = percent_of(*words.override_text);
    if (!percent) return wrong(percent.message());
    wishes.override_percent = *percent;
  }
  pb::RobotReport report;
  report.set_order(order_name(words.order));
  report.set_place(options.address + ":" + std::to_string(options.command_port));
  report.set_done(false);
  report.set_ready(false);
  const bool on = words.order == RobotOrder::kOn;
  if (on) {
    const SlaveView view = slave_view(place);
    report.set_note(view.note);
    if (!view.stop.empty()) {
      report.set_problem("the slave holds a stop: " + view.stop);
      report.set_next("take its cause away, then handrail reset");
      return end_with(report, words, place);
    }
  }
  // Off is short, and is not broken off.
  const auto line =
      R3Socket::connect(options.address, options.command_port,
                        words.order == RobotOrder::kOff ? R3Socket::Interrupted{}
                                                        : R3Socket::Interrupted(place.interrupted));
  if (!line) {
    const Obstacle o = obstacle_in(line.message());
    report.set_problem(o.fact);
    report.set_next(o.next);
    return end_with(report, words, place);
  }
  add(carry_out(words.order, **line, wishes), wishes, report);
  if (on && report.done() && report.after().override_percent() < 100)
    report.set_note(kSlowOverride);
  return end_with(report, words, place);
}

}  // namespace handrail
