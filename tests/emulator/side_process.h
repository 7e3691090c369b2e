// The first process of a side: makes its surroundings, starts and reaps its programs.
#pragma once

#include <string>
#include <vector>

#include "tests/emulator/network.h"

namespace handrail::emulator {

struct SideSetup {
  Side side = Side::kNear;
  int mtu = static_cast<int>(kLongestPacket);  // [bytes]
  std::vector<std::string> shared;             // folders both sides see as they are
};

// Words of the messages over the socket.
inline constexpr const char* kReady = "ready";      // from the side: with the device's descriptor
inline constexpr const char* kRefused = "refused";  // from the side: why
inline constexpr const char* kRun = "run";          // to the side: name, words; maybe an output
inline constexpr const char* kSignal = "signal";    // to the side: name, number
inline constexpr const char* kStarted = "started";  // from a program before it is one: name
inline constexpr const char* kFailed = "failed";    // from a program that is none: name, why
inline constexpr const char* kEnded = "ended";      // from the side: name, status as of wait

// Runs in new network, mount, IPC and process namespaces, as their first process, with the user ids
// `own_user` says it has to map. Ends with its parent, and everything that it started ends with it.
// Never returns.
[[noreturn]] void be_side(int socket, const SideSetup& setup, bool own_user, unsigned user,
                          unsigned group);

}  // namespace handrail::emulator
