#include "tests/emulator/orders.h"

#include <signal.h>
#include <string.h>

#include <charconv>
#include <memory>
#include <utility>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/random.h"
#include "tests/emulator/network_io.h"
#include "tests/emulator/report.h"

namespace handrail::emulator {

const char* const kOrders =
    "  network NAME|FILE        another network from now on\n"
    "  change TEXT              as in a file: change to_far { loss: 1 } outage { for_s: 2 }\n"
    "  roam                     near has another address\n"
    "  rebind                   near's ports change; with nat\n"
    "  run SIDE NAME LINE       a further program, by the shell\n"
    "  signal SIDE NAME SIGNAL  to a program and what it started; those of the command line are\n"
    "                           called main; KILL, STOP, CONT, TERM ...\n"
    "  inject SIDE FROM TO HEX  a datagram to a side, addresses as 10.77.0.2:5000 or "
    "[fd77::2]:5000\n"
    "  flood SIDE FROM TO PER_SECOND SECONDS BYTES   of junk\n"
    "  replay SIDE TAP PER_SECOND    what was delivered to the side in a tap, again\n"
    "  reflect SIDE TAP PER_SECOND   what the side sent in a tap, back to it\n"
    "  report                   what happened so far, as --json; the taps have it, too\n"
    "  end                      the run\n";

namespace {

constexpr std::size_t kLargestPayload = kLongestPacket - 48;  // IPv6 and UDP before it [bytes]
constexpr double kMostPerSecond = 1e6, kLongestFlood = 3600.0;

// The first word of `text`, taken off it.
std::string take_word(std::string_view& text) {
  const std::size_t start = text.find_first_not_of(' ');
  if (start == std::string_view::npos) {
    text = {};
    return {};
  }
  const std::size_t end = std::min(text.find(' ', start), text.size());
  std::string out(text.substr(start, end - start));
  text = text.substr(std::min(text.find_first_not_of(' ', end), text.size()));
  return out;
}

template <typename T>
Status take(std::string_view& text, const char* name, T& out);

template <>
Status take(std::string_view& text, const char*, Side& out) {
  const std::string word = take_word(text);
  if (word != "near" && word != "far") {
    return Status::error("side '" + word + "': expected near or far");
  }
  out = word == "near" ? Side::kNear : Side::kFar;
  return Status::ok();
}

template <>
Status take(std::string_view& text, const char* name, Endpoint& out) {
  const Result<Endpoint> read = read_endpoint(take_word(text));
  if (!read) return Status::error(std::string(name) + " " + read.message());
  out = *read;
  return Status::ok();
}

template <>
Status take(std::string_view& text, const char* name, std::string& out) {
  out = take_word(text);
  return out.empty() ? Status::error(std::string(name) + ": missing") : Status::ok();
}

Status take_number(std::string_view& text, const char* name, double low, double high, double& out) {
  const std::string word = take_word(text);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (error == std::errc() && end == word.data() + word.size() && out >= low && out <= high) {
    return Status::ok();
  }
  return Status::error(std::string(name) + " '" + word + "': expected a number from " +
                       number_text(low) + " to " + number_text(high));
}

Status read_hex(const std::string& text, std::vector<std::uint8_t>& out) {
  if (text.size() % 2 != 0 || text.size() > 2 * kLargestPayload) {
    return Status::error("HEX: " + std::to_string(text.size()) +
                         " digits, expected an even number up to " +
                         std::to_string(2 * kLargestPayload));
  }
  for (std::size_t i = 0; i < text.size(); i += 2) {
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(text.data() + i, text.data() + i + 2, byte, 16);
    if (error != std::errc() || end != text.data() + i + 2) {
      return Status::error("HEX: '" + text.substr(i, 2) + "' at digit " + std::to_string(i + 1));
    }
    out.push_back(byte);
  }
  return Status::ok();
}

// Who a datagram is said to be from, and whom it is for.
Status take_ends(std::string_view& text, Side& to, Endpoint& source, Endpoint& destination) {
  if (Status s = take(text, "SIDE", to); !s) return s;
  if (Status s = take(text, "FROM", source); !s) return s;
  if (Status s = take(text, "TO", destination); !s) return s;
  if (source.address.size == destination.address.size) return Status::ok();
  return Status::error("FROM and TO: one is IPv4 and the other IPv6");
}

// The packets of a tap that the side got from the wire, or those that it sent, turned around.
Result<std::vector<std::vector<std::uint8_t>>> packets_of(const std::string& path, bool reflected) {
  auto records = read_tap(path);
  if (!records) return records.status();
  std::vector<std::vector<std::uint8_t>> out;
  for (TapRecord& record : *records) {
    if (record.sent != reflected || record.origin != Origin::kGenuine) continue;
    const auto layout = layout_of(record.packet);
    if (!layout || record.packet.size() > kLongestPacket) continue;
    if (reflected) {
      const Endpoint source = source_of(record.packet, *layout);
      set_source(record.packet, *layout, destination_of(record.packet, *layout));
      set_destination(record.packet, *layout, source);
    }
    out.push_back(std::move(record.packet));
  }
  if (out.empty()) return Status::error(path + ": has no packet to send");
  return out;
}

}  // namespace

Status Orders::set_network(const std::string& name) {
  const auto loaded = load_network(name);
  if (!loaded) return loaded.status();
  plan_ = *loaded;
  emulator_.network().begin(plan_, emulator_.now());
  return Status::ok();
}

Status Orders::change(std::string_view text) {
  if (Status changed = change_network("change", text, plan_); !changed) return changed;
  emulator_.network().change(plan_, emulator_.now());
  return Status::ok();
}

Status Orders::rebind() {
  if (!plan_.edge.nat) return Status::error("rebind: the network has no nat");
  emulator_.network().rebind();
  return Status::ok();
}

Status Orders::run(std::string_view rest) {
  Side side{};
  std::string name;
  if (Status s = take(rest, "SIDE", side); !s) return s;
  if (Status s = take(rest, "NAME", name); !s) return s;
  if (name.find('/') != std::string::npos) return Status::error("NAME '" + name + "': has a '/'");
  if (rest.empty()) return Status::error("LINE: missing");
  return emulator_.run(side, name, {"/bin/sh", "-c", std::string(rest)});
}

Status Orders::signal(std::string_view rest) {
  Side side{};
  std::string name, wanted;
  if (Status s = take(rest, "SIDE", side); !s) return s;
  if (Status s = take(rest, "NAME", name); !s) return s;
  if (Status s = take(rest, "SIGNAL", wanted); !s) return s;
  const auto& programs = emulator_.side(side).programs();
  const auto found = programs.find(name);
  if (found == programs.end() || found->second.ended) {
    return Status::error("'" + name + "': no such program runs there");
  }
  for (int number = 1; number < NSIG; ++number) {
    const char* const abbreviated = ::sigabbrev_np(number);
    if (abbreviated == nullptr || wanted != abbreviated) continue;
    emulator_.side(side).signal(name, number);
    return Status::ok();
  }
  return Status::error("SIGNAL '" + wanted + "': expected a name such as KILL or STOP");
}

Status Orders::inject(std::string_view rest) {
  Side to{};
  Endpoint source, destination;
  std::vector<std::uint8_t> payload;
  if (Status s = take_ends(rest, to, source, destination); !s) return s;
  if (Status s = read_hex(take_word(rest), payload); !s) return s;
  emulator_.network().inject(to, make_udp(source, destination, payload), emulator_.now());
  return Status::ok();
}

Status Orders::flood(std::string_view rest) {
  Side to{};
  Endpoint source, destination;
  double rate = 0.0, seconds = 0.0, bytes = 0.0;
  if (Status s = take_ends(rest, to, source, destination); !s) return s;
  if (Status s = take_number(rest, "PER_SECOND", 1.0, kMostPerSecond, rate); !s) return s;
  if (Status s = take_number(rest, "SECONDS", 0.0, kLongestFlood, seconds); !s) return s;
  constexpr double kMost = static_cast<double>(kLargestPayload);
  if (Status s = take_number(rest, "BYTES", 0.0, kMost, bytes); !s) return s;
  // One packet whose payload is drawn anew each time.
  struct Junk {
    Random random{0};
    Endpoint source, destination;
    std::vector<std::uint8_t> payload, packet;
  };
  const auto junk = std::make_shared<Junk>();
  junk->source = source;
  junk->destination = destination;
  junk->payload.resize(static_cast<std::size_t>(bytes));
  const auto next = [junk]() -> std::span<const std::uint8_t> {
    for (std::size_t i = 0; i < junk->payload.size(); i += 8) {
      const std::uint64_t bits = junk->random.bits();
      ::memcpy(junk->payload.data() + i, &bits, std::min<std::size_t>(8, junk->payload.size() - i));
    }
    junk->packet = make_udp(junk->source, junk->destination, junk->payload);
    return junk->packet;
  };
  emulator_.inject({to, rate, static_cast<std::uint64_t>(rate * seconds), next});
  return Status::ok();
}

Status Orders::replay(std::string_view rest, bool reflected) {
  Side to{};
  std::string path;
  double rate = 0.0;
  if (Status s = take(rest, "SIDE", to); !s) return s;
  if (Status s = take(rest, "TAP", path); !s) return s;
  if (Status s = take_number(rest, "PER_SECOND", 1.0, kMostPerSecond, rate); !s) return s;
  auto packets = packets_of(path, reflected);
  if (!packets) return packets.status();
  const std::uint64_t count = packets->size();
  const auto next = [all = std::move(*packets), i = std::size_t{0}]() mutable {
    return std::span<const std::uint8_t>(all[i++]);
  };
  emulator_.inject({to, rate, count, next});
  return Status::ok();
}

Result<std::string> Orders::obey(const std::string& verb, std::string_view rest) {
  const auto answer = [](const Status& status) -> Result<std::string> {
    if (!status) return status;
    return std::string();
  };
  if (verb == "network") return answer(set_network(std::string(rest)));
  if (verb == "change") return answer(change(rest));
  if (verb == "rebind") return answer(rebind());
  if (verb == "run") return answer(run(rest));
  if (verb == "signal") return answer(signal(rest));
  if (verb == "inject") return answer(inject(rest));
  if (verb == "flood") return answer(flood(rest));
  if (verb == "replay" || verb == "reflect") return answer(replay(rest, verb == "reflect"));
  if (verb == "report") {
    emulator_.flush_taps();
    return to_json(emulator_.report());
  }
  if (verb == "roam") emulator_.network().roam();
  if (verb == "end") ended_ = true;
  if (verb == "roam" || verb == "end") return std::string();
  return Status::error("'" + verb +
                       "': expected network, change, roam, rebind, run, signal, inject, flood, "
                       "replay, reflect, report or end");
}

std::string Orders::carry_out(const std::string& line) {
  std::string_view rest = line;
  const std::string verb = take_word(rest);
  const Result<std::string> done = obey(verb, rest);
  if (!done) return "error: " + done.message();
  return done->empty() ? "ok" : "ok " + *done;
}

}  // namespace handrail::emulator
