// The way to spacenavd.
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

struct SpnavConnection {
  int fd = -1;  // never blocks
};

// Where spacenavd listens: `configured`, else what $SPNAV_SOCKET says, else its own usual place.
std::string spnav_socket_path(const std::string& configured);

// Connects and asks for protocol 1. Waits for nobody. The error names the socket, the cause and
// what to do.
Result<SpnavConnection> connect_spnav(const std::string& path);

}  // namespace handrail
