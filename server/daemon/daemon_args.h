// The command line that every daemon has.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "server/base/status.h"

namespace handrail {

// What the user asked for. `help` and `version` win over everything else.
struct DaemonArgs {
  std::string config_path;  // empty: defaults
  // Of the options below; empty: as configured.
  std::string link;       // where the other side of the encrypted link is
  std::string operators;  // where operators on other computers are waited for
  bool check = false;     // read and check the configuration, then exit
  bool help = false;
  bool version = false;
};

// One that a daemon has beside those of all, and that takes an address or a host.
struct DaemonOption {
  std::string name;  // "--link"
  std::string help;
  std::string DaemonArgs::*target;
};
using DaemonOptions = std::span<const DaemonOption>;

// Reads `--config FILE` (or `--config=FILE`), those of `options`, `--check`, `--help`/`-h` and
// `--version`. Anything else, one given twice or without its value is an error that names the
// argument; daemons print it and exit with 2.
Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv, DaemonOptions options = {});

// The text for --help: `program` in one line with `what_it_does` (a sentence), then the options.
std::string daemon_help(const std::string& program, const std::string& what_it_does,
                        DaemonOptions options = {});

// What every daemon does before its work: prints --help or --version and returns 0, or 1 where the
// standard output takes no more; prints what is wrong with the arguments and returns 2; or returns
// nothing: go on.
std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does, DaemonOptions options = {});

}  // namespace handrail
