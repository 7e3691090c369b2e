// The command line that every daemon has.
#pragma once

#include <optional>
#include <string>

#include "server/base/status.h"

namespace handrail {

// What the user asked for. `help` and `version` win over everything else.
struct DaemonArgs {
  std::string config_path;  // empty: defaults
  bool check = false;       // read and check the configuration, then exit
  bool help = false;
  bool version = false;
};

// Reads `--config FILE` (or `--config=FILE`), `--check`, `--help`/`-h` and `--version`. Anything
// else, a repeated `--config` or a missing FILE is an error that names the argument; daemons print
// it and exit with 2.
Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv);

// The text for --help: `program` in one line with `what_it_does` (a sentence), then the options.
std::string daemon_help(const std::string& program, const std::string& what_it_does);

// What every daemon does before its work: prints --help or --version and returns 0, or 1 where the
// standard output takes no more; prints what is wrong with the arguments and returns 2; or returns
// nothing: go on.
std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does);

}  // namespace handrail
