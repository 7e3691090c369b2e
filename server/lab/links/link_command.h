// handrail-lab links: which links can be driven over.
#pragma once

#include <atomic>
#include <vector>

namespace handrail {

struct LinkCommand {
  std::vector<double> delays_ms;   // one way; empty: the coarse map's
  std::vector<double> jitters_ms;  // +-
  std::vector<double> losses;      // [%]
  bool in_order = false;
  int seeds = 1;
  int threads = 0;  // 0: one a core; results do not depend on it
  bool json = false;
};

// A LabExit; kFailed where the auditor found a violation.
int run_link_command(const LinkCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
