#include "client/console/console_args.h"

#include <algorithm>
#include <cstdlib>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/ip/address.hpp>
#include <utility>

#include "server/base/operator_name.h"
#include "server/base/own_places.h"
#include "server/base/plain_text.h"
#include "server/keys/host_port.h"

namespace handrail {
namespace {

constexpr char kUsualName[] = "console";
constexpr std::size_t kMostNames = 16;

Status set_listen(const std::string& text, ConsoleArgs& out) {
  const auto where = parse_host(text, 0, 0);
  if (!where) return Status::error("--listen " + where.message());
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(where->host, error);
  if (error && where->host != "any") {
    return Status::error("--listen " + shown(text) +
                         ": expected any, or an address of this computer: one that only this "
                         "computer reaches such as 127.0.0.1:0, or one that others reach such as "
                         "192.0.2.7:47004, over TLS");
  }
  const bool is_any = error || address.is_unspecified();
  out.encrypted = is_any || !address.is_v4() || !address.is_loopback();
  out.address = is_any ? "any" : address.to_string();
  // Which port is not named is known from what is said without one.
  out.port = out.encrypted ? parse_host(text, kConsolePort, 0)->port : where->port;
  return Status::ok();
}

Status add_name(const std::string& text, ConsoleArgs& out) {
  std::string name = text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  boost::system::error_code none;
  boost::asio::ip::make_address(name, none);
  const bool plain =
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.-") == std::string::npos;
  if ((none && !plain) || name.size() > 253 || out.names.size() >= kMostNames) {
    return Status::error("--name " + shown(text) +
                         ": expected a name or an address of this computer without a port, such as "
                         "desk.example.org, " +
                         std::to_string(kMostNames) + " at most");
  }
  out.names.push_back(name);
  return Status::ok();
}

Status set_name(const std::string& text, ConsoleArgs& out) {
  const std::string problem = operator_name_problem(text);
  if (!problem.empty()) return Status::error("--as: " + problem);
  out.as = text;
  return Status::ok();
}

Status set_master(const std::string& text, ConsoleArgs& out) {
  const auto host = parse_host(text, kOperatorPort);
  if (!host) return Status::error("--master " + host.message());
  out.master.host = text;
  return Status::ok();
}

Status set_viewer_origin(const std::string& text, ConsoleArgs& out) {
  const std::size_t scheme = text.find("://");
  if (scheme == std::string::npos || scheme == 0 ||
      text.find('/', scheme + 3) != std::string::npos ||
      text.find_first_of("?#* ") != std::string::npos) {
    return Status::error("--viewer-origin " + shown(text) +
                         ": expected the origin of a viewer's page, without a path, such as "
                         "https://app.foxglove.dev");
  }
  out.viewer_origins.push_back(text);
  return Status::ok();
}

struct ConsoleOption {
  const char* name;
  const char* value;
  const char* help;
  Status (*set)(const std::string& text, ConsoleArgs& out);
};

constexpr ConsoleOption kOptions[] = {
    {"--listen", "ADDRESS[:PORT]",
     "where a browser finds it (127.0.0.1:0); any, or one that others reach: over TLS", set_listen},
    {"--name", "HOST", "as browsers there call this computer; may be given again", add_name},
    {"--socket", "PATH", "the master's socket (or HANDRAIL_SOCKET)",
     [](const std::string& text, ConsoleArgs& out) {
       out.master.socket = text;
       return Status::ok();
     }},
    {"--master", "HOST[:PORT]", "a master on another computer, with your key (or HANDRAIL_MASTER)",
     set_master},
    {"--as", "NAME", "who drives, as others see it (console)", set_name},
    {"--page", "FOLDER", "the page's files, instead of those shipped",
     [](const std::string& text, ConsoleArgs& out) {
       out.page = text;
       return Status::ok();
     }},
    {"--scenes", "FOLDER", "searched before the scenes shipped; may be given again",
     [](const std::string& text, ConsoleArgs& out) {
       out.scenes.push_back(text);
       return Status::ok();
     }},
    {"--rig", "SOCKET", "the status_socket of handrail-rig, which says what its workpiece does",
     [](const std::string& text, ConsoleArgs& out) {
       out.rig = text;
       return Status::ok();
     }},
    {"--recording", "FILE.mcap",
     "shows a recording in place of a master: no order can be given, and a bar of time plays it",
     [](const std::string& text, ConsoleArgs& out) {
       out.recording = text;
       return Status::ok();
     }},
    {"--viewer-origin", "ORIGIN",
     "of a viewer that is a page, such as https://app.foxglove.dev; may be given again",
     set_viewer_origin},
};

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// By which names browsers find it.
Status set_names(ConsoleArgs& out) {
  if (!out.encrypted) {
    if (!out.names.empty()) {
      return Status::error("--name: expected with --listen at an address that others reach");
    }
    out.names = {out.address, "localhost"};
    return Status::ok();
  }
  if (!out.viewer_origins.empty()) {
    return Status::error("--viewer-origin " + shown(out.viewer_origins.front()) +
                         ": viewers are served on this computer alone, and --listen " +
                         out.address + " is reached by others");
  }
  if (out.address != "any") out.names.push_back(out.address);
  if (!out.names.empty()) return Status::ok();
  return Status::error(
      "--listen any: expected --name HOST too: a browser is served only where it "
      "asks for a name or an address that is listed");
}

// Of a recording nothing that is of a master.
Status check_recording(const std::vector<std::string>& given) {
  for (const char* other : {"--socket", "--master", "--as", "--rig", "--scenes"}) {
    if (std::find(given.begin(), given.end(), other) == given.end()) continue;
    return Status::error(std::string("--recording and ") + other +
                         ": expected one of them: a recording has no master, and its own scenes");
  }
  return Status::ok();
}

Status set_defaults(const std::vector<std::string>& given, ConsoleArgs& out) {
  if (Status named = set_names(out); !named) return named;
  if (!out.recording.empty()) return check_recording(given);
  const bool socket_given = std::find(given.begin(), given.end(), "--socket") != given.end();
  if (out.master.host.empty() && !socket_given) {
    const std::string host = variable("HANDRAIL_MASTER");
    if (!host.empty()) {
      if (Status set = set_master(host, out); !set) return set;
    }
  }
  if (out.master.socket.empty()) out.master.socket = variable("HANDRAIL_SOCKET");
  if (out.master.socket.empty()) out.master.socket = default_operator_socket();
  const bool remote = !out.master.host.empty();
  if (remote && socket_given) return Status::error("--socket and --master: expected one of them");
  if (remote && !out.as.empty()) return Status::error("--as: over the network your key says it");
  if (!remote && out.as.empty()) out.as = kUsualName;
  return Status::ok();
}

}  // namespace

Result<ConsoleArgs> parse_console_args(int argc, const char* const* argv) {
  ConsoleArgs out;
  std::vector<std::string> seen;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") out.help = true;
    if (word == "--version") out.version = true;
    if (word == "--observe") out.observe = true;
    if (word == "--json") out.json = true;
    const bool flag = word == "--help" || word == "-h" || word == "--version" ||
                      word == "--observe" || word == "--json";
    if (flag) continue;
    const std::string name = word.substr(0, word.find('='));
    const auto option = std::find_if(std::begin(kOptions), std::end(kOptions),
                                     [&](const ConsoleOption& o) { return name == o.name; });
    if (option == std::end(kOptions)) {
      return Status::error("unknown argument '" + shown(word) + "' (see --help)");
    }
    const bool again = name == "--scenes" || name == "--name" || name == "--viewer-origin";
    if (!again && std::find(seen.begin(), seen.end(), name) != seen.end()) {
      return Status::error(name + " is given twice");
    }
    seen.push_back(name);
    const bool inside = word.size() > name.size();
    if (!inside && i + 1 >= argc) return Status::error(name + ": expected " + option->value);
    const std::string value = inside ? word.substr(name.size() + 1) : argv[++i];
    if (value.empty()) return Status::error(name + ": expected " + option->value);
    if (Status set = option->set(value, out); !set) return set;
  }
  if (out.help || out.version) return out;
  if (Status set = set_defaults(seen, out); !set) return set;
  return out;
}

std::string console_help() {
  std::string out =
      "handrail-console: the master's picture, and its orders, for a browser.\n"
      "Prints one address; whoever opens it is in, and nobody else. SIGTERM ends it.\n"
      "Prints another one for viewers, Foxglove or Lichtblick: whoever opens that may look.\n"
      "Where other computers reach it, `handrail keys link` makes addresses that are good "
      "once, and viewers are not served.\n\n";
  for (const ConsoleOption& option : kOptions) {
    std::string row = std::string("  ") + option.name + " " + option.value;
    row.resize(std::max<std::size_t>(row.size() + 2, 28), ' ');
    out += row + option.help + "\n";
  }
  out +=
      "  --observe                 only look: no order passes\n"
      "  --json                    the addresses as one line of JSON, once it is ready\n"
      "  --help, --version\n";
  return out;
}

}  // namespace handrail
