// Where a master is.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace handrail {

// Where a master's operator_port is, unless it is told another.
inline constexpr std::uint16_t kOperatorPort = 47003;

// One on this computer, by its operator socket's path; or, where `host` says something, one on
// another, HOST or HOST:PORT, over TLS 1.3 with this user's key.
struct MasterPlace {
  MasterPlace() = default;
  MasterPlace(std::string path) : socket(std::move(path)) {}  // NOLINT: a path is a place
  MasterPlace(const char* path) : socket(path) {}             // NOLINT

  std::string socket;
  std::string host;
};

// How an error begins that has to do with reaching it.
inline std::string name_of(const MasterPlace& place) {
  return place.host.empty() ? "no master on " + place.socket
                            : "no session with a master at " + place.host;
}

}  // namespace handrail
