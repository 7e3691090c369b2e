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
  std::string address = "127.0.0.1";  // of this computer, of the loopback
  std::uint16_t port = 0;             // 0: any that is free
  MasterPlace master;
  std::string as;  // who speaks to the master; over the network empty: its key says
  bool observe = false;
  std::string page;                         // folder of the page; empty: the shipped one
  std::vector<std::string> scenes;          // folders searched before the shipped ones
  std::vector<std::string> viewer_origins;  // of pages that may look as viewers
  bool help = false, version = false;
};

// The error names the argument and says what was expected. An address that others can reach is
// refused: there is nothing yet that would keep them out.
Result<ConsoleArgs> parse_console_args(int argc, const char* const* argv);

std::string console_help();

}  // namespace handrail
