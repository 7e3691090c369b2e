#include "tests/emulator/netfault_args.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <filesystem>
#include <random>
#include <utility>

#include "server/base/plain_text.h"
#include "tests/emulator/network_io.h"
#include "tests/emulator/orders.h"

namespace handrail::emulator {
namespace {

constexpr int kLeastMtu = 1280;  // IPv6's [bytes]

const std::vector<std::string> kNames = {"--network", "--set",    "--seed", "--until",
                                         "--orders",  "--output", "--tap",  "--share",
                                         "--mtu",     "--json",   "--help", "--tap-bytes"};

Status unexpected(const std::string& name, const std::string& value, const std::string& expected) {
  return Status::error(name + " '" + value + "': expected " + expected);
}

template <typename Number>
bool read_whole(const std::string& text, Number& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size();
}

// A folder that is there, by its full path.
Status read_folder(const std::string& name, const std::string& value, std::string& out) {
  std::error_code error;
  const auto path = std::filesystem::canonical(value, error);
  if (error || !std::filesystem::is_directory(path, error)) {
    return unexpected(name, value, "a folder that exists");
  }
  out = path.string();
  return Status::ok();
}

Status read_until(const std::string& value, Until& out) {
  if (value == "near") out = Until::kNear;
  if (value == "far") out = Until::kFar;
  if (value == "any") out = Until::kAny;
  if (value == "both") out = Until::kBoth;
  const bool known = value == "near" || value == "far" || value == "any" || value == "both";
  return known ? Status::ok() : unexpected("--until", value, "near, far, any or both");
}

// `seeded`: whether one was given.
Status read_option(const std::string& name, const std::string& value, NetfaultArgs& out,
                   bool& seeded) {
  EmulatorOptions& options = out.options;
  if (name == "--network") {
    auto loaded = load_network(value);
    if (!loaded) return Status::error("--network " + loaded.message());
    options.plan = std::move(*loaded);
    return Status::ok();
  }
  if (name == "--set") return change_network("--set", value, options.plan);
  if (name == "--until") return read_until(value, out.until);
  if (name == "--output") return read_folder(name, value, options.output);
  if (name == "--tap") return read_folder(name, value, out.taps);
  if (name == "--share") return read_folder(name, value, options.shared.emplace_back());
  if (name == "--seed") {
    seeded = read_whole(value, options.seed);
    return seeded ? Status::ok() : unexpected(name, value, "a whole number from 0 on");
  }
  if (name == "--tap-bytes") {
    const bool good =
        read_whole(value, out.tap_bytes) && out.tap_bytes >= 1 && out.tap_bytes <= kLongestPacket;
    return good ? Status::ok() : unexpected(name, value, fmt::format("1 to {}", kLongestPacket));
  }
  if (name == "--mtu") {
    const bool good = read_whole(value, options.mtu) && options.mtu >= kLeastMtu &&
                      options.mtu <= static_cast<int>(kLongestPacket);
    return good ? Status::ok()
                : unexpected(name, value, fmt::format("{} to {}", kLeastMtu, kLongestPacket));
  }
  out.orders = value;
  return Status::ok();
}

// "-- near: CMD ... -- far: CMD ...", from `at` on. A "--" of a command's own stays in it.
Status read_commands(const std::vector<std::string>& words, std::size_t at, NetfaultArgs& out) {
  std::vector<std::string>* into = nullptr;
  for (; at < words.size(); ++at) {
    const std::string next = at + 1 < words.size() ? words[at + 1] : "";
    if (words[at] == "--" && (next == "near:" || next == "far:")) {
      into = next == "near:" ? &out.near : &out.far;
      if (!into->empty()) return Status::error("'" + next + "': given twice");
      ++at;
    } else if (into == nullptr) {
      return Status::error("'" + next + "' behind '--': expected near: or far:");
    } else {
      into->push_back(words[at]);
    }
  }
  return Status::ok();
}

Status check(const NetfaultArgs& args) {
  if (args.near.empty() && args.far.empty() && args.orders.empty()) {
    return Status::error("nothing to run: expected -- near: CMD ... -- far: CMD ..., or --orders");
  }
  if (args.until == Until::kNear && args.near.empty()) {
    return Status::error("--until near: nothing runs there");
  }
  if (args.until == Until::kFar && args.far.empty()) {
    return Status::error("--until far: nothing runs there");
  }
  return Status::ok();
}

}  // namespace

Result<NetfaultArgs> read_args(const std::vector<std::string>& words) {
  NetfaultArgs out;
  bool seeded = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& name = words[i];
    if (name == "--") {
      if (Status read = read_commands(words, i, out); !read) return read;
      break;
    }
    if (name == "--help" || name == "-h") {
      out.help = true;
      return out;
    }
    if (name == "--json") {
      out.json = true;
      continue;
    }
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
      const std::string nearest = nearest_name(name, kNames);
      return Status::error(
          "'" + name + "': " +
          (nearest.empty() ? "expected " + joined(kNames, ", ") : "did you mean " + nearest + "?"));
    }
    if (i + 1 == words.size()) return Status::error(name + ": its value is missing");
    if (Status read = read_option(name, words[++i], out, seeded); !read) return read;
  }
  // Small enough to be typed.
  if (!seeded) out.options.seed = std::random_device()() % 1'000'000;
  if (Status good = check(out); !good) return good;
  return out;
}

std::string usage() {
  std::string networks;
  for (const KnownNetwork& network : known_networks()) {
    networks += fmt::format("  {:9} {}\n", network.name, network.what);
  }
  return fmt::format(
      "usage: handrail-netfault [OPTION...] -- near: CMD [ARG...] -- far: CMD [ARG...]\n\n"
      "Runs two commands on two sides that have nothing in common but a network that is made up "
      "from a\nseed: near is 10.77.0.1 and fd77::1, far is 10.77.0.2 and fd77::2. /tmp, /var/tmp, "
      "/dev/shm and\n/run are each side's own and empty, and so are HOME and XDG_RUNTIME_DIR. "
      "Prints what the network\ndid. Exit codes: 0 what was waited for ended well, 1 it did not, "
      "2 usage or bad file, 77 this\nmachine does not allow it, 130 stopped.\n\n"
      "  --network NAME|FILE  clear when absent; a file is a Network of proto/network.proto\n"
      "  --set TEXT           changes it, as in a file: 'both {{ delay_ms: 50 }}'\n"
      "  --seed N             drawn and printed when absent\n"
      "  --until WHO          whose end ends the run: near, far, any (default) or both\n"
      "  --orders PLACE       takes orders: - from the standard input, else from a Unix socket\n"
      "  --output FOLDER      what the commands print goes to near-main.out and far-main.out "
      "there\n"
      "  --tap FOLDER         every packet goes to near.pcap and far.pcap there\n"
      "  --tap-bytes N        of each packet; all of them when absent\n"
      "  --share FOLDER       is seen by both sides as it is; may be given again\n"
      "  --mtu BYTES          of both sides, {} to {} (default)\n"
      "  --json               what the network did in one line\n\n"
      "networks:\n{}\norders, each answered by a line with ok or error:\n{}",
      kLeastMtu, kLongestPacket, networks, kOrders);
}

}  // namespace handrail::emulator
