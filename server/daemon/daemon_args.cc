#include "server/daemon/daemon_args.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string_view>
#include <utility>

#include "server/base/output.h"
#include "server/base/version.h"

namespace handrail {
namespace {

Status bad(std::string_view argument, std::string_view expected) {
  return Status::error("argument '" + std::string(argument) + "': " + std::string(expected));
}

}  // namespace

Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv, bool has_link) {
  DaemonArgs args;
  struct Valued {
    std::string_view name, expected;
    std::string& target;
    bool given = false;
  };
  std::array<Valued, 2> valued = {
      Valued{"--config", "expected the path of a configuration file after it", args.config_path},
      Valued{"--link", "expected an address or a host after it", args.link}};
  const auto all = std::span(valued).first(has_link ? 2 : 1);
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto of = std::find_if(all.begin(), all.end(), [&](const Valued& v) {
      return argument == v.name || (argument.starts_with(v.name) && argument[v.name.size()] == '=');
    });
    if (of != all.end()) {
      if (std::exchange(of->given, true)) return bad(of->name, "given twice, expected once");
      const bool apart = argument == of->name;
      const bool has_value = i + 1 < argc && !std::string_view(argv[i + 1]).starts_with("--");
      if (!apart) of->target = argument.substr(of->name.size() + 1);
      if (apart && has_value) of->target = argv[++i];
      if (of->target.empty()) return bad(of->name, of->expected);
    } else if (argument == "--check") {
      args.check = true;
    } else if (argument == "--help" || argument == "-h") {
      args.help = true;
    } else if (argument == "--version") {
      args.version = true;
    } else {
      return bad(argument, std::string("unknown, expected --config FILE, ") +
                               (has_link ? "--link WHERE, " : "") + "--check, --help or --version");
    }
  }
  return args;
}

std::string daemon_help(const std::string& program, const std::string& what_it_does,
                        const std::string& link_help) {
  return "usage: " + program + " [--config FILE]" + (link_help.empty() ? "" : " [--link WHERE]") +
         " [--check]\n\n" + what_it_does +
         "\n\n"
         "  --config FILE  configuration in protobuf text format; without it, the defaults\n" +
         (link_help.empty() ? "" : "  --link WHERE   " + link_help + "\n") +
         "  --check        read and check the configuration, say what is wrong with it, and exit\n"
         "  --help, -h     this text\n"
         "  --version      the version\n\n"
         "Exit: 0 done, 1 failed, 2 bad argument, configuration or address.\n";
}

std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does, const std::string& link_help) {
  if (!args) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), args.message().c_str());
    return 2;
  }
  if (args->help) {
    std::fputs(daemon_help(program, what_it_does, link_help).c_str(), stdout);
    return end_output(program, 0);
  }
  if (args->version) {
    std::printf("%s %s\n", program.c_str(), program_version());
    return end_output(program, 0);
  }
  return std::nullopt;
}

}  // namespace handrail
