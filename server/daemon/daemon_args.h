// The command line that every daemon has.
#pragma once

#include <optional>
#include <string>

#include "server/base/status.h"

namespace handrail {

// What the user asked for. `help` and `version` win over everything else.
struct DaemonArgs {
  std::string config_path;  // empty: defaults
  std::string link;         // where the other side of the encrypted link is; empty: as configured
  bool check = false;       // read and check the configuration, then exit
  bool help = false;
  bool version = false;
};

// Reads `--config FILE` (or `--config=FILE`), `--link WHERE` where `has_link`, `--check`,
// `--help`/`-h` and `--version`. Anything else, one given twice or without its value is an error
// that names the argument; daemons print it and exit with 2.
Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv, bool has_link = false);

// The text for --help: `program` in one line with `what_it_does` (a sentence), then the options.
// `link_help`: of --link; empty: the program has none.
std::string daemon_help(const std::string& program, const std::string& what_it_does,
                        const std::string& link_help = {});

// What every daemon does before its work: prints --help or --version and returns 0, or 1 where the
// standard output takes no more; prints what is wrong with the arguments and returns 2; or returns
// nothing: go on.
std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does,
                                  const std::string& link_help = {});

}  // namespace handrail
