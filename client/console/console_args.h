// The command line of handrail-console.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/api/master_place.h"
#include "server/base/status.h"

namespace handrail {

struct ConsoleArgs {
  std::string address = "127.0.0.1";  // of this computer, or "any"
  std::uint16_t port = 0;             // 0: any that is free
  bool encrypted = false;             // other computers reach that address
  std::vector<std::string> names;     // as browsers call this computer there, lower case
  MasterPlace master;
  std::string as;  // who speaks to the master; over the network empty: its key says
  bool observe = false;
  std::string page;                         // folder of the page; empty: the shipped one
  std::vector<std::string> scenes;          // folders searched before the shipped ones
  std::string rig;                          // the simulated rig's status socket; empty: none
  std::vector<std::string> viewer_origins;  // of pages that may look as viewers
  std::string recording;  // a file that is shown in place of a master; empty: none
  bool json = false;      // what is printed is for a program
  bool help = false, version = false;
};

// Of a console that other computers reach, where no port is named (TCP).
inline constexpr std::uint16_t kConsolePort = 47004;

// The error names the argument and says what was expected.
Result<ConsoleArgs> parse_console_args(int argc, const char* const* argv);

std::string console_help();

}  // namespace handrail
