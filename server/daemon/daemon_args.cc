#include "server/daemon/daemon_args.h"

#include <cstdio>
#include <string_view>

#include "server/base/output.h"

namespace handrail {
namespace {

constexpr std::string_view kConfig = "--config";

Status bad(std::string_view argument, std::string_view expected) {
  return Status::error("argument '" + std::string(argument) + "': " + std::string(expected));
}

}  // namespace

Result<DaemonArgs> parse_daemon_args(int argc, const char* const* argv) {
  DaemonArgs args;
  bool has_config = false;
  const auto set_config = [&](std::string_view file) -> Status {
    if (has_config) return bad(kConfig, "given twice, expected once");
    if (file.empty()) return bad(kConfig, "expected the path of a configuration file after it");
    has_config = true;
    args.config_path = file;
    return Status::ok();
  };
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--check") {
      args.check = true;
    } else if (argument == "--help" || argument == "-h") {
      args.help = true;
    } else if (argument == "--version") {
      args.version = true;
    } else if (argument == kConfig) {
      const bool has_file = i + 1 < argc && !std::string_view(argv[i + 1]).starts_with("--");
      if (Status s = set_config(has_file ? argv[++i] : ""); !s) return s;
    } else if (argument.starts_with("--config=")) {
      if (Status s = set_config(argument.substr(kConfig.size() + 1)); !s) return s;
    } else {
      return bad(argument, "unknown, expected --config FILE, --check, --help or --version");
    }
  }
  return args;
}

std::string daemon_help(const std::string& program, const std::string& what_it_does) {
  return "usage: " + program + " [--config FILE] [--check]\n\n" + what_it_does +
         "\n\n"
         "  --config FILE  configuration in protobuf text format; without it, the defaults\n"
         "  --check        read and check the configuration, say what is wrong with it, and exit\n"
         "  --help, -h     this text\n"
         "  --version      the version\n\n"
         "Exit: 0 done, 1 failed, 2 bad argument, configuration or address.\n";
}

std::optional<int> answer_at_once(const Result<DaemonArgs>& args, const std::string& program,
                                  const std::string& what_it_does) {
  if (!args) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), args.message().c_str());
    return 2;
  }
  if (args->help) {
    std::fputs(daemon_help(program, what_it_does).c_str(), stdout);
    return end_output(program, 0);
  }
  if (args->version) {
    std::printf("%s %s\n", program.c_str(), HANDRAIL_VERSION);
    return end_output(program, 0);
  }
  return std::nullopt;
}

}  // namespace handrail
