// Where on this computer the programs of one user meet, when they are not told another place.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <string>

namespace handrail {

// 127.0.0.1 and the user's number more: 127.0.0.1 of root, 127.0.3.233 of user 1000. All addresses
// that begin with 127 are this computer, and each has ports of its own: so two users can start the
// same programs with the same ports. Numbers of 16777214 (2^24 - 2) and more begin anew.
inline std::string own_address() {
  const std::uint32_t host = 1 + ::geteuid() % ((1u << 24) - 2);
  return "127." + std::to_string(host >> 16) + "." + std::to_string(host >> 8 & 0xff) + "." +
         std::to_string(host & 0xff);
}

// The socket where operators find a master. A folder for each user: one user's master does not keep
// another's from starting.
inline std::string default_operator_socket() {
  return "/tmp/handrail-" + std::to_string(::geteuid()) + "/operator.sock";
}

// Where the slave of one user meets its master, when nobody says another place. As above.
inline std::string default_link_socket() {
  return "/tmp/handrail-" + std::to_string(::geteuid()) + "/link.sock";
}

// Where a master of that slave listens: beside it, one for each process.
inline std::string master_socket(const std::string& link_socket, ::pid_t master) {
  return link_socket + ".master-" + std::to_string(master);
}

}  // namespace handrail
