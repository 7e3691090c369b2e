#include "server/daemon/daemon_args.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/output.h"
#include "server/base/version.h"

namespace handrail {
namespace {

Status bad(std::string_view argument, std::string_view expected) {
  return Status::error("argument '" + std::string(argument) + "': " + std::string(expected));
}

}  // namespace

Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv, DaemonOptions options) {
  DaemonArgs args;
  struct Valued {
    std::string_view name, expected;
    std::string* target;
    bool given = false;
  };
  std::vector<Valued> all = {
      {"--config", "expected the path of a configuration file after it", &args.config_path}};
  std::string places;
  for (const DaemonOption& option : options) {
    all.push_back({option.name, "expected an address or a host after it", &(args.*option.target)});
    places.append(option.name).append(" WHERE, ");
  }
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto of = std::find_if(all.begin(), all.end(), [&](const Valued& v) {
      return argument == v.name || (argument.starts_with(v.name) && argument[v.name.size()] == '=');
    });
    if (of != all.end()) {
      if (std::exchange(of->given, true)) return bad(of->name, "given twice, expected once");
      const bool apart = argument == of->name;
      const bool has_value = i + 1 < argc && !std::string_view(argv[i + 1]).starts_with("--");
      if (!apart) *of->target = argument.substr(of->name.size() + 1);
      if (apart && has_value) *of->target = argv[++i];
      if (of->target->empty()) return bad(of->name, of->expected);
    } else if (argument == "--check") {
      args.check = true;
    } else if (argument == "--help" || argument == "-h") {
      args.help = true;
    } else if (argument == "--version") {
      args.version = true;
    } else {
      return bad(argument, std::string("unknown, expected --config FILE, ") + places +
                               "--check, --help or --version");
    }
  }
  return args;
}

std::string daemon_help(const std::string& program, const std::string& what_it_does,
                        DaemonOptions options) {
  std::string usage = "usage: " + program + " [--config FILE]", lines;
  const auto line = [&lines](std::string option, const std::string& help) {
    constexpr std::size_t kColumn = 19;  // "--operators WHERE" and two blanks
    option.resize(std::max(kColumn, option.size()), ' ');
    lines.append("  ").append(option).append(help).append("\n");
  };
  line("--config FILE", "configuration in protobuf text format; without it, the defaults");
  for (const DaemonOption& option : options) {
    usage.append(" [").append(option.name).append(" WHERE]");
    line(option.name + " WHERE", option.help);
  }
  line("--check", "read and check the configuration, say what is wrong with it, and exit");
  line("--help, -h", "this text");
  line("--version", "the version");
  return usage + " [--check]\n\n" + what_it_does + "\n\n" + lines +
         "\nExit: 0 done, 1 failed, 2 bad argument, configuration or address.\n";
}

std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does, DaemonOptions options) {
  if (!args) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), args.message().c_str());
    return 2;
  }
  if (args->help) {
    std::fputs(daemon_help(program, what_it_does, options).c_str(), stdout);
    return end_output(program, 0);
  }
  if (args->version) {
    std::printf("%s %s\n", program.c_str(), program_version());
    return end_output(program, 0);
  }
  return std::nullopt;
}

}  // namespace handrail
