#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <limits>
#include <thread>

#include "client/cli/calibrate_command.h"
#include "client/cli/command.h"
#include "client/cli/demo_command.h"
#include "client/cli/doctor_command.h"
#include "client/cli/engage_command.h"
#include "client/cli/hand_command.h"
#include "client/cli/interrupt.h"
#include "client/cli/keys_command.h"
#include "client/cli/lease_command.h"
#include "client/cli/pair_command.h"
#include "client/cli/record/play_command.h"
#include "client/cli/record/record_files.h"
#include "client/cli/scene_command.h"
#include "client/cli/status_command.h"
#include "client/cli/tool_command.h"
#include "client/cli/vector_text.h"
#include "client/experiment/experiment_run.h"
#include "client/experiment/experiment_task.h"
#include "client/experiment/rehearsal/wall_rehearsal.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

ExitCode run_mark(const Options& o, const Console& c) {
  pb::Request r;
  r.set_mark(o.word.value_or("cli"));
  return send_order(o, c, r, "marked");
}

// Says where the recording stands, once the master has begun it.
ExitCode run_record_start(const Options& o, const Console& c) {
  constexpr Nanos kPatience = 2 * kSecond;
  constexpr auto kPause = std::chrono::milliseconds(20);
  pb::Request r;
  r.mutable_record()->set_on(true);
  if (o.word) r.mutable_record()->set_label(*o.word);
  if (const ExitCode code = send_order(o, c, r, "recording"); code != kExitDone) return code;
  pb::Request ask;
  ask.set_status(true);
  for (const Nanos begun = monotonic_now(); monotonic_now() - begun < kPatience;) {
    const auto reply = OperatorClient(o.master, o.as).call(ask, kPatience);
    if (!reply) return complain(c, reply.message());
    const pb::RecordingStatus& state = reply->status().recording();
    if (state.has_file()) {
      c.out << state.file() << '\n';
      return kExitDone;
    }
    if (state.has_problem()) {
      c.err << "handrail: " << state.problem() << '\n';
      return kExitRefused;
    }
    std::this_thread::sleep_for(kPause);
  }
  c.err << "handrail: the master does not say where it records\n";
  return kExitRefused;
}

// Where the master writes, if none is named.
ExitCode run_record_list(const Options& o, const Console& c) {
  std::string folder = o.word.value_or("");
  if (folder.empty()) {
    pb::Request ask;
    ask.set_status(true);
    const auto reply = OperatorClient(o.master, o.as).call(ask, 2 * kSecond);
    if (!reply) return complain(c, reply.message() + "; or name a folder: record list FOLDER");
    folder = reply->status().recording().folder();
    if (folder.empty())
      return complain(c, "the master records nothing; name a folder: record list FOLDER");
  }
  // The master makes it with its first recording.
  if (!o.word && !std::filesystem::exists(folder)) {
    c.out << (o.json ? "[]\n" : "no recordings in " + folder + " yet\n");
    return kExitDone;
  }
  const auto text = recordings_text(folder, o.json);
  if (!text) return complain(c, text.message());
  c.out << *text;
  return kExitDone;
}

ExitCode run_record_repair(const Options& o, const Console& c) {
  const auto text = repair_text(*o.word, *o.out);
  if (!text) return complain(c, text.message());
  c.out << *text;
  return kExitDone;
}

ExitCode run_play(const Options& o, const Console& c) {
  return complain(c, become_player({*o.word, o.listen, o.json}).message());
}

ExitCode run_record_stop(const Options& o, const Console& c) {
  pb::Request r;
  r.mutable_record()->set_on(false);
  return send_order(o, c, r, "the recording ends");
}

ExitCode run_stage(const Options& o, const Console& c) {
  pb::Request r;
  r.set_stage(*o.word);
  return send_order(o, c, r, "stage " + *o.word);
}

// Its range is the master's to judge.
ExitCode run_screw(const Options& o, const Console& c) {
  constexpr double kAny = std::numeric_limits<double>::max();
  const Result<double> wanted = parse_number("screw", *o.word, -kAny, kAny, "N s/(m rad)");
  if (!wanted) {
    return complain(c, "screw: '" + shown(*o.word) + "' is not a number [N s/(m rad)]");
  }
  pb::Request r;
  r.set_screw_c(*wanted);
  return send_order(o, c, r, "screw: c goes to " + *o.word);
}

constexpr int kMostTrials = 20, kMostRehearsed = 10'000;

// A whole number from 1 on; 0: it is none.
int count_in(const std::string& text, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && value >= 1 && value <= most ? value : 0;
}

ExitCode run_experiment_command(const Options& options, const Console& console) {
  ExperimentWords words;
  words.experiment = *options.word;
  const std::vector<std::string>& known = experiment_names();
  if (std::find(known.begin(), known.end(), words.experiment) == known.end()) {
    return complain(console, fmt::format("experiment: there is no '{}', expected {}",
                                         shown(words.experiment), fmt::join(known, ", ")));
  }
  if (options.folder) words.folder = *options.folder;
  words.rig = options.rig.value_or("");
  words.resume = options.resume;
  words.simulated = options.simulated;
  words.json = options.json;
  if (options.trials) words.trials = count_in(*options.trials, kMostTrials);
  if (options.trials && words.trials == 0) {
    return complain(console,
                    "experiment: --trials '" + shown(*options.trials) + "', expected 1 to 20");
  }
  const ExperimentPlace place{options.master, options.as,  console.out,
                              console.err,    interrupted, console.in};
  if (options.rehearse) {
    if (options.subject || options.report || options.simulated || options.resume) {
      return complain(console, "experiment: --rehearse goes with --json alone");
    }
    const int people = count_in(*options.rehearse, kMostRehearsed);
    if (people == 0) {
      return complain(console, "experiment: --rehearse '" + shown(*options.rehearse) +
                                   "', expected 1 to 10000");
    }
    catch_interrupts();
    const auto text = rehearsal_text(words.experiment, people, words.json, interrupted);
    if (!text) return complain(console, "experiment: " + text.message());
    console.out << *text;
    return kExitDone;
  }
  if (options.report) return report_experiment(words, options.figures.value_or(""), place);
  if (options.figures) return complain(console, "experiment: --figures goes with --report");
  if (!options.subject) {
    return complain(console, "experiment: expected --subject ID, or --report");
  }
  words.subject = *options.subject;
  catch_interrupts();
  return run_experiment(words, place);
}

constexpr Command kCommands[] = {
    {"status",
     "Show session, link, loop, tools, forces and poses",
     run_status,
     {.json = true, .watch = true}},
    {"why", "Why the robot is not where the hand is", run_why, {.json = true, .watch = true}},
    {"doctor",
     "What is wrong with keys, link and machine, and what to type",
     run_doctor,
     {.json = true, .configs = true}},
    {"devices list",
     "Which devices are there, and what each still needs",
     run_devices_list,
     {.json = true, .devices = true}},
    {"devices test",
     "Drive a device through its axes, buttons and rate; with --force its force",
     run_devices_test,
     {.json = true, .word = "NAME", .devices = true, .device_test = true}},
    {"devices calibrate",
     "Find out what a device's block of configuration has to say",
     run_devices_calibrate,
     {.json = true, .word = "NAME", .devices = true}},
    {"engage", "Let the hand drive the arm", run_engage, {.hold = true}},
    {"disengage", "Stop following; the arm holds", run_disengage, {}},
    {"clutch", "on: hand free, arm holds; off: follow again", run_clutch, {.word = "on|off"}},
    {"stop", "Stop the arm now; stays stopped until reset", run_stop, {}},
    {"reset", "Release a stop or a fault", run_reset, {}},
    {"lease show", "Who may drive, and who asks to", run_lease_show, {.json = true}},
    {"lease take",
     "Take a free lease, or ask its holder and wait for the answer",
     run_lease<pb::LeaseOrder::TAKE>,
     {}},
    {"lease grant",
     "Give the lease to who asks; the arm holds until they engage",
     run_lease<pb::LeaseOrder::GRANT>,
     {}},
    {"lease refuse", "Keep the lease from who asks", run_lease<pb::LeaseOrder::REFUSE>, {}},
    {"lease release", "Give the lease back; the arm holds", run_lease<pb::LeaseOrder::RELEASE>, {}},
    {"tool point",
     "Keep the tip on a point",
     run_tool<pb::Tool::POINT>,
     {.tool = "--at --approach --stiffness"}},
    {"tool line",
     "Keep the tip on a line",
     run_tool<pb::Tool::LINE>,
     {.tool = "--at --dir --end --one-way --approach --stiffness"}},
    {"tool plane",
     "Keep the tip on a plane",
     run_tool<pb::Tool::PLANE>,
     {.tool = "--at --normal --dir --end --one-way --approach --stiffness"}},
    {"tool n-rotation",
     "Keep the orientation, or bring the tip to one and keep that",
     run_tool<pb::Tool::N_ROTATION>,
     {.tool = "--turn"}},
    {"tool f-rotation",
     "Keep one axis, turn freely about it",
     run_tool<pb::Tool::F_ROTATION>,
     {.tool = "--axis --tip-axis"}},
    {"tool call",
     "Call a tool that the scene names",
     run_tool_call,
     {.approach = true, .word = "NAME"}},
    {"tool list", "The tools that the scene names", run_tool_list, {.json = true}},
    {"tool off",
     "Drop the tools, or only one of them",
     run_tool_off,
     {.word = "position|orientation", .word_optional = true}},
    {"scene list", "List the scenes found", run_scene_list, {.json = true}},
    {"scene show",
     "Show a scene with its defaults",
     run_scene_show,
     {.json = true, .word = "NAME|FILE"}},
    {"scene check", "Check a scene file", run_scene_check, {.json = true, .word = "NAME|FILE"}},
    {"scene preview",
     "Draw a scene's walls, forces and a proxy's way",
     run_scene_preview,
     {.file = "FILE.png", .word = "NAME|FILE"}},
    {"scene explain",
     "What a scene simulates, where, and what it costs",
     run_scene_explain,
     {.json = true, .word = "NAME|FILE"}},
    {"scene resolve",
     "Copy a scene with the cheapest setting that meets a wish",
     run_scene_resolve,
     {.file = "NAME.scene", .wish = true, .word = "NAME|FILE"}},
    {"scene load", "Load a scene in master and slave", run_scene_load, {.word = "NAME"}},
    {"stage", "Put the walls as they are in a stage of the scene", run_stage, {.word = "NAME"}},
    {"screw", "How the friction of a wrench's screw grows: c of (2.2)", run_screw, {.word = "C"}},
    {"robot grip", "Close the gripper; the arm must be engaged", run_grip, {}},
    {"robot release", "Open the gripper; the arm must be engaged", run_release, {}},
    {"robot status",
     "What the controller's own switches say: mode, servos, program, override, alarm",
     run_robot_status,
     {.json = true, .switches = true}},
    {"robot on",
     "Servos on and the program for real-time control started; nothing moves by itself",
     run_robot_on,
     {.json = true, .switches = true, .override_percent = true}},
    {"robot off",
     "Stop the controller's program and switch its servos off",
     run_robot_off,
     {.json = true, .switches = true}},
    {"robot reset",
     "Reset the controller's alarm; `handrail reset` is for the slave's own stop",
     run_robot_reset,
     {.json = true, .switches = true}},
    {"mark",
     "Say that something is done now: an experiment's next step",
     run_mark,
     {.word = "TEXT", .word_optional = true}},
    {"record start",
     "Write down all that happens, on both sides",
     run_record_start,
     {.word = "LABEL", .word_optional = true}},
    {"record stop", "End the recording", run_record_stop, {}},
    {"record mark",
     "Say that something is done now; it stands in the recording",
     run_mark,
     {.word = "TEXT"}},
    {"record list",
     "The recordings on this computer",
     run_record_list,
     {.json = true, .word = "FOLDER", .word_optional = true}},
    {"record repair",
     "A whole copy of a recording that was cut, as far as it is sound",
     run_record_repair,
     {.file = "FILE.mcap", .word = "FILE"}},
    {"play",
     "Show a recording in a browser, or in Foxglove: with a bar of time, and no orders",
     run_play,
     {.json = true, .word = "FILE", .play = true}},
    {"keys new",
     "Make this user's key, for what it is to be trusted to do; or the next one, to change it",
     run_keys_new,
     {.word = "ROLES"}},
    {"keys retire",
     "End the old key now, whoever has not confirmed the next one",
     run_keys_retire,
     {}},
    {"keys show",
     "The line that another computer types to trust this key",
     run_keys_show,
     {.json = true}},
    {"keys trust",
     "Let another computer's key in, as `keys show` prints it there",
     run_keys_trust,
     {.word = "NAME", .entry = true}},
    {"keys pair",
     "Trust each other: one side shows a code, the other is told it (--with)",
     run_keys_pair,
     {.word = "ROLE", .pair = true}},
    {"keys list", "Whose keys are let in, and as what", run_keys_list, {.json = true}},
    {"keys remove", "Let a key in no longer; its session ends", run_keys_remove, {.word = "NAME"}},
    {"keys link",
     "An address that lets a browser on another computer in once, as operator or observer",
     run_keys_link,
     {.word = "ROLE", .life = true}},
    {"keys links", "Which of these there are", run_keys_links, {.json = true}},
    {"keys unlink", "Remove one; pages that it let in end", run_keys_unlink, {.word = "ID"}},
    {"hand to", "Move the simulated hand", run_hand_to, {.hand = true}},
    {"hand home", "Bring the simulated hand back to where it began", run_hand_home, {}},
    {"calibrate payload",
     "What hangs on the force sensor: watches while you tilt the tip, moves nothing",
     run_calibrate_payload,
     {.json = true, .calibrate = true}},
    {"experiment",
     "One person's trials of an experiment of the dissertation, judged and written down",
     run_experiment_command,
     {.json = true,
      .word = "linear-movement|gearshift|wrench|wrench-loosening|screw-fastening",
      .experiment = true}},
    {"demo",
     "Drive A to B to C with the simulated hand, without and with tools",
     run_demo,
     {.json = true}},
};

}  // namespace

std::span<const Command> commands() { return kCommands; }

std::string group_help(const std::string& word) {
  if (word == "tool") return "Call and drop virtual tools (mm and directions in the robot base)";
  if (word == "scene") return "Look at scenes, load one";
  if (word == "lease") return "Who drives: one operator at a time, by name (--as)";
  if (word == "calibrate") return "Find what the slave's file has to say of this arm";
  if (word == "keys") return "Who may reach the programs of this user over the network";
  if (word == "robot") return "The arm's gripper, and its controller's own switches";
  if (word == "record") return "Write down what happens, and what to do with recordings";
  if (word == "devices")
    return "Hand, stop switch, arm and force sensor: are they there, do they work";
  if (word == "hand") return "Move the hand of a simulated device";
  return {};
}

ExitCode complain(const Console& console, const std::string& text) {
  console.err << "handrail: " << text << '\n';
  return kExitUsage;
}

ExitCode send_order(const Options& options, const Console& console, const pb::Request& request,
                    const std::string& done_text, Nanos patience) {
  OperatorClient client(options.master, options.as);
  const Result<pb::Reply> reply = client.call(request, patience);
  if (!reply) {
    console.err << "handrail: " << reply.message() << '\n';
  } else if (!reply->done()) {
    console.err << "handrail: refused: " << reply->reason() << '\n';
  } else {
    console.out << done_text << (reply->reason().empty() ? "" : " (" + reply->reason() + ")")
                << '\n';
  }
  return exit_code(reply);
}

}  // namespace handrail
