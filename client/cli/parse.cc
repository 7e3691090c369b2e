// The only file that knows the argument parser.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <map>

#include "client/cli/command.h"
#include "server/base/hand_move.h"
#include "server/base/operator_name.h"
#include "server/base/own_places.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/base/version.h"
#include "server/keys/host_port.h"
#include "server/scene/field_check.h"

namespace handrail {
namespace {

CLI::Option* add_text(CLI::App& app, const char* name, std::optional<std::string>& target,
                      const char* type, const char* help) {
  return app
      .add_option_function<std::string>(
          name, [&target](const std::string& text) { target = text; }, help)
      ->type_name(type);
}

CLI::Option* add_approach(CLI::App& app, Options& o) {
  return app.add_flag("--approach", o.approach,
                      "let the arm go to a far tool by itself; the clutch ends it");
}

// Every tool takes every option, so that one without meaning gets an answer that says so; help
// shows those `meant`.
void add_tool_options(CLI::App& app, Options& o, const std::string& meant) {
  const char* direction = "x,y,z or x|y|z";
  CLI::Option* const all[] = {
      add_text(app, "--at", o.at, "x,y,z", "anchor in mm; without it the present tip"),
      add_text(app, "--dir", o.direction, direction, "forward; letters with or without sign"),
      add_text(app, "--normal", o.normal, direction, "normal of the plane"),
      add_text(app, "--axis", o.axis, direction, "axis to keep; without it the tool's own"),
      add_text(app, "--turn", o.turn, "rx,ry,rz",
               "orientation to bring the tip to: rotation vector in degrees from straight down"),
      add_text(app, "--tip-axis", o.tip_axis, direction, "axis of the tip to bring onto --axis"),
      add_text(app, "--end", o.end, "x,y,z", "no travel past this point in mm"),
      app.add_flag("--one-way", o.one_way, "forward only; without it both ways"),
      add_approach(app, o),
      add_text(app, "--stiffness", o.stiffness, "N/mm", "at the hand, 0 to 10; 0 is the scene's"),
  };
  for (CLI::Option* option : all) {
    if (meant.find(option->get_name()) == std::string::npos) option->group("");
  }
}

void add_hand_options(CLI::App& app, Options& o) {
  const std::string by = "displacement in mm: right, up, toward the user; at most " +
                         number_text(kFarthestHandMove / kMm) + " long";
  const std::string rotate =
      "rotation vector in degrees, at most " + number_text(kWidestHandTurn / kDeg) + " long";
  const std::string seconds = "duration of the move, " + number_text(kShortestHandMove) + " to " +
                              number_text(kLongestHandMove) + "; 1 without it";
  add_text(app, "--by", o.by, "x,y,z", by.c_str());
  add_text(app, "--rotate", o.rotate, "rx,ry,rz", rotate.c_str());
  add_text(app, "--seconds", o.seconds, "T", seconds.c_str());
}

void add_calibrate_options(CLI::App& app, Options& o) {
  add_text(app, "--poses", o.poses, "N", "orientations to take, 4 to 50; 6 without it");
  add_text(app, "--from", o.from, "FILE.csv", "samples recorded before, instead of a running arm");
  add_text(app, "--record", o.record, "FILE.csv", "new file for the samples");
  add_text(app, "--out", o.out, "FILE", "new file for the payload block of the slave's file");
}

void add_pair_options(CLI::App& app, Options& o) {
  add_text(app, "--listen", o.listen, "ADDRESS[:PORT]",
           "wait at this one; without it at every address, TCP port 47002");
  add_text(app, "--with", o.with, "HOST[:PORT]", "the side that waits and shows the code");
  add_text(app, "--code", o.code, "DIGITS", "its code; without this you are asked for it");
}

void add_experiment_options(CLI::App& app, Options& o) {
  add_text(app, "--subject", o.subject, "ID", "who makes it; one file each");
  add_text(app, "--out", o.folder, "DIR", "where files are written; experiments without it");
  add_text(app, "--trials", o.trials, "N",
           "successes that count in each mode, 1 to 20; 2 without it");
  add_text(app, "--rig-socket", o.rig, "PATH",
           "screw-fastening: the status_socket of handrail-rig, which says what the screw does");
  app.add_flag("--resume", o.resume, "go on where this subject ended");
  app.add_flag("--simulated", o.simulated, "a simulated operator in place of a person");
  app.add_flag("--report", o.report, "what all in the folder have done, without a master");
  add_text(app, "--figures", o.figures, "DIR", "with --report: draw them there");
  add_text(
      app, "--rehearse", o.rehearse, "N",
      "gearshift, wrench: one trial each of N simulated people in virtual time, without a master");
}

void add_config_options(CLI::App& app, Options& o) {
  add_text(app, "--master-config", o.master_config, "FILE", "the file of handrail-master");
  add_text(app, "--slave-config", o.slave_config, "FILE", "the file of handrail-slave");
}

void add_device_options(CLI::App& app, bool test, Options& o) {
  add_config_options(app, o);
  add_text(app, "--device", o.device, "PATH", "the stop switch, such as /dev/input/event5");
  if (test) {
    app.add_flag("--alone", o.alone, "nobody is there: only what can be seen at rest");
    add_text(app, "--force", o.force, "N", "push the hand with up to this force, 0 to 40");
  }
}

void add_options(CLI::App& app, const Takes& takes, Options& o) {
  if (takes.json) app.add_flag("--json", o.json, "print JSON");
  if (takes.watch) app.add_flag("--watch", o.watch, "refresh 5 times a second until Ctrl-C");
  if (takes.tool != nullptr) add_tool_options(app, o, takes.tool);
  if (takes.approach) add_approach(app, o);
  if (takes.hold) app.add_flag("--hold", o.hold, "engaged while this runs: Ctrl-C disengages");
  if (takes.hand) add_hand_options(app, o);
  if (takes.experiment) add_experiment_options(app, o);
  if (takes.configs) add_config_options(app, o);
  if (takes.switches) {
    add_text(app, "--slave-config", o.slave_config, "FILE", "the file of handrail-slave");
  }
  if (takes.override_percent) {
    add_text(app, "--override", o.override_percent, "PERCENT",
             "the speed override that is wanted, 1 to 100; without it 100 is expected");
  }
  if (takes.devices) add_device_options(app, takes.device_test, o);
  if (takes.devices && takes.word != nullptr) {
    add_text(app, "--out", o.out, "FILE", "new file for the block of configuration");
  }
  if (takes.pair) add_pair_options(app, o);
  if (takes.life) {
    add_text(app, "--for", o.minutes, "MINUTES", "that it is good for, 1 to 1440; 10 without it");
  }
  if (takes.play) {
    add_text(app, "--listen", o.listen, "ADDRESS[:PORT]",
             "where a browser finds it; this computer and any free port without it");
  }
  if (takes.calibrate) add_calibrate_options(app, o);
  if (takes.wish) {
    add_text(app, "--accuracy", o.accuracy, "LENGTH", "largest error, such as 0.01mm or 10um");
    add_text(app, "--budget", o.budget, "TIME", "largest cost of an update, such as 500ns");
  }
  if (takes.file != nullptr) {
    add_text(app, "--out", o.out, takes.file, "file to write")->required();
  }
  if (takes.word == nullptr) return;
  app.add_option_function<std::string>(
         takes.word, [&o](const std::string& text) { o.word = text; }, "")
      ->required(!takes.word_optional);
  if (!takes.entry) return;
  for (const auto& [name, target] : {std::pair("ROLES", &o.roles), std::pair("KEY", &o.key)}) {
    app.add_option_function<std::string>(
           name, [target = target](const std::string& text) { *target = text; }, "")
        ->required();
  }
  app.add_option_function<std::string>(
      "NEXT", [&o](const std::string& text) { o.next = text; }, "the key that is to replace it");
}

std::string default_socket() {
  if (const char* path = std::getenv("HANDRAIL_SOCKET"); path != nullptr && *path != '\0') {
    return path;
  }
  return default_operator_socket();
}

// Why `text` names no computer and port; empty: it does.
std::string host_problem(std::string& text) {
  const auto host = parse_host(text, kOperatorPort);
  return host ? std::string() : host.message();
}

std::string default_master() {
  const char* host = std::getenv("HANDRAIL_MASTER");
  return host == nullptr ? "" : host;
}

// The first words of the commands after `group`, which ends with a blank or is empty.
std::vector<std::string> words_after(const std::string& group) {
  std::vector<std::string> out;
  for (const Command& command : commands()) {
    const std::string name = command.name;
    if (!name.starts_with(group)) continue;
    out.push_back(name.substr(group.size(), name.find(' ', group.size()) - group.size()));
  }
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// Names a word that is no command, and the nearest that is one, or what is missing; empty when
// there is nothing to say.
std::string unknown_command(const std::vector<std::string>& args) {
  std::string group;
  for (std::size_t i = 0; i < args.size(); ++i) {
    if (args[i] == "--socket" || args[i] == "--master" || args[i] == "--as") {
      ++i;  // its value
      continue;
    }
    if (args[i] == "--json" || args[i] == "--watch") continue;
    if (args[i].starts_with('-')) return {};  // with a value or without, the parser knows
    const std::vector<std::string> words = words_after(group);
    if (std::find(words.begin(), words.end(), args[i]) == words.end()) {
      const std::string nearest = nearest_name(args[i], words);
      return "no command '" + group + args[i] + "'" +
             (nearest.empty() ? "; there are " + joined(words, ", ")
                              : "; did you mean '" + group + nearest + "'?");
    }
    if (words_after(group + args[i] + ' ').empty()) return {};
    group += args[i] + ' ';
  }
  return "expected a command after 'handrail" +
         (group.empty() ? "" : " " + group.substr(0, group.size() - 1)) +
         "': " + joined(words_after(group), ", ") + " (see handrail --help)";
}

}  // namespace

ExitCode run_cli(const std::vector<std::string>& args, const Console& console) {
  CLI::App app("Operate a Handrail master: engage, call tools, watch.", "handrail");
  Options options;
  options.master.socket = default_socket();
  app.require_subcommand(1);
  app.fallthrough();
  CLI::Option* const socket =
      app.add_option("--socket", options.master.socket, "the master's socket (or HANDRAIL_SOCKET)")
          ->type_name("PATH");
  app.add_option("--master", options.master.host,
                 "a master on another computer, with your key (or HANDRAIL_MASTER)")
      ->type_name("HOST[:PORT]")
      ->excludes(socket)
      ->check(CLI::Validator(host_problem, "", "host"));
  app.add_option("--as", options.as, "who you are; without it the master's user")
      ->type_name("NAME")
      ->check(
          CLI::Validator([](std::string& who) { return operator_name_problem(who); }, "", "name"));
  app.set_version_flag("--version", std::string("handrail ") + program_version());
  app.footer("Exit: 0 done, 1 refused, 2 usage or bad file, 3 no master, 130 ended by Ctrl-C.");
  std::map<std::string, CLI::App*> groups;
  std::vector<std::pair<CLI::App*, const Command*>> leaves;
  for (const Command& command : commands()) {
    const std::string name = command.name;
    const std::size_t blank = name.find(' ');
    CLI::App* parent = &app;
    if (blank != std::string::npos) {
      CLI::App*& group = groups[name.substr(0, blank)];
      if (group == nullptr) {
        group = app.add_subcommand(name.substr(0, blank), group_help(name.substr(0, blank)));
        group->require_subcommand(1)->fallthrough();
      }
      parent = group;
    }
    const std::string last = blank == std::string::npos ? name : name.substr(blank + 1);
    CLI::App* leaf = parent->add_subcommand(last, command.help)->fallthrough();
    add_options(*leaf, command.takes, options);
    leaves.emplace_back(leaf, &command);
  }
  if (const std::string unknown = unknown_command(args); !unknown.empty()) {
    return complain(console, unknown);
  }
  try {
    app.parse(std::vector<std::string>(args.rbegin(), args.rend()));
  } catch (const CLI::Success& help) {
    app.exit(help, console.out, console.err);
    return kExitDone;
  } catch (const CLI::ParseError& error) {
    return complain(console, std::string(error.what()) + " (see handrail --help)");
  }
  if (options.master.host.empty() && socket->count() == 0) {
    options.master.host = default_master();
    const bool given = !options.master.host.empty();
    const std::string problem = given ? host_problem(options.master.host) : std::string();
    if (!problem.empty()) return complain(console, "HANDRAIL_MASTER " + problem);
  }
  for (const auto& [leaf, command] : leaves) {
    if (leaf->parsed()) return command->run(options, console);
  }
  return complain(console, "no command (see handrail --help)");
}

}  // namespace handrail
