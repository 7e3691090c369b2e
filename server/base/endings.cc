#include "server/base/endings.h"

#include <signal.h>

namespace handrail {

std::vector<int> ending_signals() {
  std::vector<int> out{SIGINT, SIGTERM};
  struct sigaction hang_up {};
  const bool known = ::sigaction(SIGHUP, nullptr, &hang_up) == 0;
  if (!known || hang_up.sa_handler != SIG_IGN) out.push_back(SIGHUP);
  return out;
}

}  // namespace handrail
