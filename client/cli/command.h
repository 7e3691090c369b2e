// The command line as one table: each command's name, help, options and function.
#pragma once

#include <istream>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "client/api/operator_client.h"

namespace handrail {

// What the user typed, not yet understood.
struct Options {
  MasterPlace master;
  std::string as;  // who speaks; empty: the master's user
  bool json = false;
  bool watch = false;
  bool one_way = false;
  bool hold = false;
  bool approach = false;
  std::optional<std::string> at, end, direction, normal, axis, stiffness;  // tools
  std::optional<std::string> turn, tip_axis;                               // tools
  std::optional<std::string> by, rotate, seconds;                          // hand
  std::optional<std::string> out, accuracy, budget;                        // scene tools
  std::optional<std::string> poses, from, record;                          // calibrate, with out
  std::optional<std::string> word;                                         // positional argument
  std::optional<std::string> roles, key, next;                             // keys trust, after it
  std::optional<std::string> listen, with, code;  // keys pair; listen: play, too
  std::optional<std::string> minutes;             // keys link
  std::optional<std::string> subject, folder, figures, trials, rig, rehearse;  // experiment
  std::optional<std::string> master_config, slave_config;                      // devices, doctor
  std::optional<std::string> force, device;                                    // devices, with out
  std::optional<std::string> override_percent;                                 // robot
  bool alone = false;                                                          // devices
  bool resume = false;
  bool simulated = false;
  bool report = false;
};

// Where answers and complaints go.
struct Console {
  std::ostream& out;
  std::ostream& err;
  bool is_terminal = false;      // `out` understands cursor movement
  bool err_is_terminal = false;  // `err` does
  std::istream* in = nullptr;    // what is asked for is read here; null: nobody is there
};

// Options a command takes, besides --socket, --master and --as which all take.
struct Takes {
  bool json = false;
  bool watch = false;
  const char* tool = nullptr;  // the tool options that mean something, by name
  bool approach = false;       // --approach, without the other tool options
  bool hand = false;
  bool hold = false;           // --hold
  const char* file = nullptr;  // what --out writes
  bool wish = false;           // --accuracy and --budget
  bool calibrate = false;      // --poses, --from, --record and an optional --out
  const char* word = nullptr;  // name of the positional argument
  bool word_optional = false;
  bool entry = false;       // ROLES, KEY and an optional NEXT after the word
  bool pair = false;        // --listen, or --with and --code
  bool life = false;        // --for
  bool experiment = false;  // --subject and what goes with it
  bool devices = false;     // --master-config, --slave-config and --device; with a word --out
  bool configs = false;     // the first two of these
  bool switches = false;    // the second of these
  bool override_percent = false;
  bool device_test = false;  // --alone and --force
  bool play = false;         // --listen
};

struct Command {
  const char* name;  // one or two words, "scene show"
  const char* help;
  ExitCode (*run)(const Options&, const Console&);
  Takes takes;
};

std::span<const Command> commands();
// Help of a first word that has several commands behind it; empty for others.
std::string group_help(const std::string& word);

// Prints the error and returns kExitUsage.
ExitCode complain(const Console& console, const std::string& text);

// Sends one order and says how it went: `done_text`, the master's refusal, or why there is none.
ExitCode send_order(const Options& options, const Console& console, const pb::Request& request,
                    const std::string& done_text, Nanos patience = 5 * kSecond);

// Parses `args` (without the program's name) and runs the command.
ExitCode run_cli(const std::vector<std::string>& args, const Console& console);

}  // namespace handrail
