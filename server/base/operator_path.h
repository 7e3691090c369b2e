// Where operators find a master that was not told where to listen.
#pragma once

#include <unistd.h>

#include <string>

namespace handrail {

// A folder for each user: one user's master does not keep another's from starting.
inline std::string default_operator_socket() {
  return "/tmp/handrail-" + std::to_string(::geteuid()) + "/operator.sock";
}

}  // namespace handrail
