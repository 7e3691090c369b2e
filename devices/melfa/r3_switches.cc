#include "devices/melfa/r3_switches.h"

#include "server/base/plain_text.h"

namespace handrail {

const char kSlowOverride[] =
    "whether the override slows real-time control is documented nowhere we know of; if it does, "
    "the arm stays behind its targets";

namespace {

// A public driver of a MELFA waits 5 s for its servos.
constexpr Nanos kServoPatience = 10 * kSecond;
constexpr Nanos kProgramPatience = 3 * kSecond;
constexpr Nanos kBetweenLooks = 100 * kMillisecond;

constexpr char kState[] = "1;1;STATE";
constexpr char kStops[] = "1;1;DSTATE";

// "alarm 6130 (Network communication error)", or of a refusal "error 5640".
std::string numbered(const char* what, int number, const std::string& text) {
  std::string out = std::string(what) + ' ' + std::to_string(number);
  return text.empty() ? out : out + " (" + text + ')';
}

// The controller's own words for a number; empty: it has none.
std::string words_for(R3Line& line, int number) {
  if (number == 0) return {};
  const auto answer = line.ask("1;1;ERRORMES" + std::to_string(number));
  return answer && answer->done ? shown(answer->body, 100) : std::string();
}

// Asks for what must be done. The obstacle names the refusal.
Obstacle must(R3Line& line, const std::string& order, const std::string& what,
              const std::string& next) {
  const auto answer = line.ask(order);
  if (!answer) return obstacle_in(answer.message());
  if (answer->done) return {};
  const std::string why =
      answer->error == 0 ? ""
                         : ", " + numbered("error", answer->error, words_for(line, answer->error));
  return {what + " was refused" + why, next, true};
}

Result<R3State> ask_state(R3Line& line) {
  const auto answer = line.ask(kState);
  if (!answer) return answer.status();
  if (answer->done) return parse_r3_state(answer->body);
  return Status::error("STATE was refused, error " + std::to_string(answer->error));
}

Result<R3Status> ask_status(R3Line& line) {
  const auto answer = line.ask(kStops);
  if (!answer) return answer.status();
  if (answer->done) return parse_r3_dstate(answer->body);
  return Status::error("DSTATE was refused, error " + std::to_string(answer->error));
}

// Looks until `wanted` says so; the obstacle tells of `patience` gone by, `otherwise`.
template <typename Wanted>
Obstacle wait_for(R3Line& line, Nanos patience, const Obstacle& otherwise, Wanted wanted) {
  for (Nanos waited = 0;; waited += kBetweenLooks) {
    const auto status = ask_status(line);
    if (!status) return obstacle_in(status.message());
    if (wanted(*status)) return {};
    if (status->alarm != 0) {
      return {
          "then " + numbered("alarm", status->alarm, words_for(line, status->alarm)) + " stands",
          "take its cause away, then handrail robot reset"};
    }
    if (waited >= patience) return otherwise;
    line.pause(kBetweenLooks);
  }
}

// Reads the state as it is before anything is done; false: there is none.
bool begin(R3Line& line, SwitchesReport& report) {
  const auto state = ask_state(line);
  if (!state) {
    report.problem = obstacle_in(state.message());
    return false;
  }
  report.before = *state;
  report.alarm_text = words_for(line, state->status.alarm);
  return true;
}

void end(R3Line& line, SwitchesReport& report) {
  const auto state = ask_state(line);
  if (state) {
    report.after = *state;
  } else if (report.problem.none()) {
    report.problem = obstacle_in(state.message());
  }
}

// What nobody can switch away from here.
Obstacle lasting_obstacle(const R3State& s, const SwitchWishes& wishes, const std::string& words) {
  if (s.status.emergency_stop()) {
    return {"the controller's emergency stop is pressed",
            "release it there, then handrail robot reset", false, Reason::kRobotStopPressed};
  }
  if (s.status.alarm != 0) {
    return {numbered("alarm", s.status.alarm, words) + " stands",
            "take its cause away, then handrail robot reset", false, Reason::kRobotAlarm};
  }
  if (s.status.teach()) {
    return {"the controller is in TEACH (manual), expected AUTOMATIC",
            "turn its key to AUTOMATIC, and switch the teaching box off", false,
            Reason::kRobotTeaching};
  }
  if (s.status.machine_lock()) {
    return {"the machine lock is on: programs run, and the arm stands",
            "take the machine lock away at the controller", false, Reason::kRobotMachineLock};
  }
  const bool named = !wishes.program.empty();
  if (s.status.running() && named && !same_program(wishes.program, s.program)) {
    return {"program '" + shown(s.program) + "' runs, expected '" + wishes.program + "'",
            "stop it at the controller, or correct robot { program } in the slave's file", false,
            Reason::kRobotProgram};
  }
  if (!s.status.running() && !named) {
    return {
        "no program runs at the controller, and none is named that opens MXT",
        "robot { program: \"NAME\" } in the slave's file, and handrail robot on; or start it at "
        "the controller",
        false, Reason::kRobotProgram};
  }
  if (s.override_percent < 100 && wishes.override_percent.value_or(0) != s.override_percent) {
    return {"the speed override is " + std::to_string(s.override_percent) +
                " %, expected 100: " + kSlowOverride,
            "handrail robot on --override 100, or --override " +
                std::to_string(s.override_percent) + " to leave it",
            false, Reason::kRobotSlow};
  }
  return {};
}

// One run of switch_on.
class SwitchingOn {
 public:
  SwitchingOn(R3Line& line, const SwitchWishes& wishes, SwitchesReport& report)
      : line_(line), wishes_(wishes), report_(report) {}

  void run() {
    Obstacle& problem = report_.problem;
    problem = must(line_, "1;1;CNTLON", "the right to operate the controller",
                   "somebody else holds it: end that program, or give it up at the teaching box");
    if (problem.refused) return;
    if (problem.none()) problem = all();
    if (problem.none() && line_.interrupted()) problem = {"broken off", ""};
    line_.finish();
    if (!problem.none()) take_back();
    const Obstacle left = must(line_, "1;1;CNTLOFF", "to give the right back", "");
    if (!left.none()) report_.steps.push_back(left.fact);
  }

 private:
  Obstacle all() {
    const R3State& found = *report_.before;
    const auto& wished = wishes_.override_percent;
    if (wished && *wished != found.override_percent) {
      if (Obstacle o = set_override(*wished); !o.none()) return o;
    }
    if (!found.status.servo_on()) {
      if (Obstacle o = servos(); !o.none()) return o;
    }
    return found.status.running() ? Obstacle{} : program();
  }

  Obstacle set_override(int percent) {
    const std::string number = std::to_string(percent);
    const auto answer = line_.ask("1;1;OVRD=" + number);
    if (!answer) return obstacle_in(answer.message());
    if (answer->done && (answer->body.empty() || answer->body == number)) {
      report_.steps.push_back("speed override set to " + number + " %");
      return {};
    }
    return {"the speed override of " + number + " % was not taken: '" + shown(answer->body) + "'",
            "set it at the controller"};
  }

  Obstacle servos() {
    if (line_.interrupted()) return {"broken off", ""};
    Obstacle o = must(line_, "1;1;SRVON", "to switch the servos on",
                      "look at the controller's panel: door, enable switch, mode");
    servos_begun_ = !o.refused;
    if (!o.none()) return o;
    o = wait_for(line_, kServoPatience,
                 {"the servos are not on 10 s after they were switched on",
                  "look at the controller's panel: door, enable switch, contactor"},
                 [](const R3Status& s) { return s.servo_on(); });
    if (o.none()) report_.steps.emplace_back("servos on");
    return o;
  }

  Obstacle program() {
    const std::string& name = wishes_.program;
    Obstacle o = must(line_, "1;1;SLOTINIT", "to reset the program's slots",
                      "look at the controller's panel: a program is being edited, or held");
    if (!o.none()) return o;
    if (line_.interrupted()) return {"broken off", ""};
    // As the public driver of rl: 1 is a cycle, not a repetition.
    o = must(line_, "1;1;RUN" + name + ";1", "to start program '" + name + "'",
             "is there a program of that name on the controller?");
    program_begun_ = !o.refused;
    if (!o.none()) return o;
    o = wait_for(line_, kProgramPatience,
                 {"program '" + name + "' does not run",
                  "it ended at once: does it open MXT, for this computer's address?"},
                 [](const R3Status& s) { return s.running(); });
    if (o.none()) report_.steps.push_back("program '" + name + "' started");
    return o;
  }

  void take_back() {
    if (program_begun_) {
      const Obstacle o = must(line_, "1;1;STOP", "to stop the program", "");
      report_.steps.push_back(o.none() ? "program stopped again" : o.fact);
    }
    if (!servos_begun_) return;
    const Obstacle o = must(line_, "1;1;SRVOFF", "to switch the servos off again", "");
    report_.steps.push_back(o.none() ? "servos switched off again" : o.fact);
  }

  R3Line& line_;
  const SwitchWishes& wishes_;
  SwitchesReport& report_;
  bool servos_begun_ = false;
  bool program_begun_ = false;
};

}  // namespace

Obstacle obstacle_in(const std::string& error) {
  const std::size_t cut = error.find("; ");
  return {error.substr(0, cut), cut == std::string::npos ? "" : error.substr(cut + 2)};
}

Obstacle obstacle_of(const R3State& state, const SwitchWishes& wishes,
                     const std::string& alarm_text) {
  SwitchWishes as_it_is = wishes;
  // Whether it can be started is another question than what keeps it from working.
  if (as_it_is.program.empty()) as_it_is.program = state.program;
  if (Obstacle o = lasting_obstacle(state, as_it_is, alarm_text); !o.none()) return o;
  if (!state.status.servo_on()) {
    return {"the servos are off", "handrail robot on", false, Reason::kRobotServosOff};
  }
  if (state.status.running()) return {};
  if (!wishes.program.empty()) {
    return {"the program '" + wishes.program + "' does not run", "handrail robot on", false,
            Reason::kRobotProgram};
  }
  return lasting_obstacle(state, wishes, alarm_text);
}

Obstacle silence_of(R3Line& line, const std::string& program) {
  SwitchesReport seen;
  if (!begin(line, seen)) return seen.problem;
  const R3State& state = *seen.before;
  const SwitchWishes any_override = {program, state.override_percent};
  Obstacle out = obstacle_of(state, any_override, seen.alarm_text);
  if (out.none()) out = obstacle_of(state, {program, std::nullopt}, seen.alarm_text);
  if (!out.none()) return out;
  return {"its switches are as they should be, and program '" + shown(state.program) + "' runs",
          "has that opened MXT, for this computer's address and robot { port }? Look at the cable "
          "and the network between the two as well"};
}

SwitchesReport look_at_switches(R3Line& line, const SwitchWishes& wishes) {
  SwitchesReport out;
  if (!begin(line, out)) return out;
  out.done = true;
  out.problem = obstacle_of(*out.before, wishes, out.alarm_text);
  return out;
}

SwitchesReport switch_on(R3Line& line, const SwitchWishes& wishes) {
  SwitchesReport out;
  if (!begin(line, out)) return out;
  R3State wished = *out.before;  // what is to be set is in nobody's way
  wished.override_percent = wishes.override_percent.value_or(wished.override_percent);
  out.problem = lasting_obstacle(wished, wishes, out.alarm_text);
  if (!out.problem.none()) return out;
  SwitchingOn(line, wishes, out).run();
  end(line, out);
  if (!out.problem.none()) return out;
  out.problem = obstacle_of(*out.after, wishes, words_for(line, out.after->status.alarm));
  out.done = out.problem.none();
  return out;
}

SwitchesReport switch_off(R3Line& line) {
  SwitchesReport out;
  line.finish();
  (void)begin(line, out);
  out.problem = {};
  const auto step = [&](const char* order, const char* what, const char* done) {
    Obstacle o = must(line, order, what, "");
    out.steps.push_back(o.none() ? done : o.fact);
    return o;
  };
  const bool rights =
      step("1;1;CNTLON", "the right to operate the controller", "right taken").none();
  if (!out.before || out.before->status.running()) {
    (void)step("1;1;STOP", "to stop the program", "program stopped");
  }
  constexpr char kPress[] = "press the controller's emergency stop";
  Obstacle last = step("1;1;SRVOFF", "to switch the servos off", "servos switched off");
  const Obstacle seen = wait_for(
      line, kProgramPatience, {"the servos are still on 3 s after they were switched off", kPress},
      [](const R3Status& s) { return !s.servo_on(); });
  if (rights) (void)step("1;1;CNTLOFF", "to give the right back", "right given back");
  end(line, out);
  out.done = out.after && !out.after->status.servo_on();
  if (out.done) {
    out.problem = {};
    return out;
  }
  if (last.none()) last = seen;
  if (!last.none()) out.problem = last;
  out.problem.next = kPress;
  return out;
}

SwitchesReport reset_alarm(R3Line& line) {
  SwitchesReport out;
  if (!begin(line, out)) return out;
  out.problem =
      must(line, "1;1;RSTALRM", "to reset the alarm", "reset it at the controller's panel");
  if (out.problem.none()) out.steps.emplace_back("alarm reset");
  end(line, out);
  if (!out.problem.none()) return out;
  const R3Status& now = out.after->status;
  out.done = now.alarm == 0;
  if (!out.done) {
    out.problem = {numbered("alarm", now.alarm, words_for(line, now.alarm)) + " stands again",
                   now.emergency_stop() ? "release the emergency stop, then handrail robot reset"
                                        : "take its cause away, then handrail robot reset"};
  }
  return out;
}

}  // namespace handrail
