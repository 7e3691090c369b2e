// Two sides, the emulated network between them, and the clock.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/histogram.h"
#include "server/base/status.h"
#include "tests/emulator/network.h"
#include "tests/emulator/side.h"
#include "tests/emulator/tap.h"

struct pollfd;

namespace handrail::emulator {

struct EmulatorOptions {
  std::uint64_t seed = 1;
  NetworkPlan plan;
  int mtu = static_cast<int>(kLongestPacket);  // [bytes]
  std::vector<std::string> shared;             // folders that both sides see
  std::string output;  // folder for what programs print, SIDE-NAME.out; empty: as the emulator does
};

// Somebody else's packets to a side, at a steady rate in bursts of a millisecond.
struct Injection {
  Side to = Side::kFar;
  double per_second = 0.0;
  std::uint64_t left = 0;
  std::function<std::span<const std::uint8_t>()> next;  // one packet
};

// What there is to say of a run.
struct Report {
  std::uint64_t seed = 0;
  double seconds = 0.0;
  Counts to_far, to_near;
  // Sent faster than they were taken, by side; not in the counts.
  std::uint64_t missed_near = 0, missed_far = 0;
  std::uint64_t refused = 0;  // delivered, but the side's kernel did not take them
  // How long after its time a packet was delivered: what the emulator adds to the network.
  Nanos late_p50 = 0, late_p999 = 0, late_worst = 0;
  std::string timing;  // what the operating system granted the emulator, and why not more
  struct Program {
    std::string side, name;
    pid_t pid = 0;
    std::string ending;
  };
  std::vector<Program> programs;
};

// Real time on one thread. Made by a process with a single thread.
class Emulator {
 public:
  // The error says what this machine does not allow.
  Status start(const EmulatorOptions& options);
  // From here on the first `most` bytes of every packet go to near.pcap and far.pcap in that
  // folder.
  Status record(const std::string& folder, std::size_t most = kLongestPacket);
  // Readers of the taps see everything so far.
  void flush_taps();

  Network& network() { return network_.value(); }
  SideHost& side(Side side) { return sides_[side == Side::kNear ? 0 : 1]; }
  Status run(Side side, const std::string& name, const std::vector<std::string>& words);
  void inject(Injection injection) { injections_.push_back({std::move(injection), now()}); }
  Nanos now() const;

  // Passes packets on until one of `others` has something, a program has ended, or `until`. False:
  // a side is gone.
  bool turn(std::span<pollfd> others, Nanos until);

  Report report() const;
  // Taps are whole from here on.
  Status close();

 private:
  struct Running {
    Injection what;
    Nanos since = 0;
    std::uint64_t done = 0;
  };
  void deliver(Nanos now);
  void read_wire(Side from);
  void inject_due(Nanos now);
  Nanos next_event(Nanos until) const;
  Tap* tap(Side side);

  EmulatorOptions options_;
  std::optional<Network> network_;
  std::array<SideHost, 2> sides_;
  std::vector<Tap> taps_;  // near's and far's, or none
  std::vector<Running> injections_;
  std::vector<std::uint8_t> in_, out_;
  Histogram late_;
  std::uint64_t refused_ = 0;
  Nanos started_ = 0;
  std::string timing_;
};

}  // namespace handrail::emulator
