#include "client/doctor/machine_cost.h"

#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>

namespace handrail {

// Column `steal` of all processors (proc(5)).
double MachineCost::stolen() noexcept {
  std::ifstream in("/proc/stat");
  std::string name;
  std::array<double, 8> ticks{};
  in >> name;
  for (double& value : ticks) in >> value;
  const long per_second = ::sysconf(_SC_CLK_TCK);
  if (!in || name != "cpu" || per_second <= 0) return -1.0;
  return ticks[7] / static_cast<double>(per_second);
}

double MachineCost::stolen_s() const noexcept {
  const double now = stolen();
  return now < 0.0 || stolen_before_ < 0.0 ? -1.0 : now - stolen_before_;
}

std::string MachineCost::text() const {
  std::array<char, 160> text{};
  const double stolen = stolen_s();
  const int n = pauses_ == 0
                    ? std::snprintf(text.data(), text.size(), "no pause of 20 ms or more")
                    : std::snprintf(text.data(), text.size(),
                                    "%d pause%s of 20 ms or more, the longest %.0f ms", pauses_,
                                    pauses_ == 1 ? "" : "s", 1e3 * to_seconds(longest_));
  std::string out(text.data(), static_cast<std::size_t>(n < 0 ? 0 : n));
  if (stolen < 0.0) return out;
  std::snprintf(text.data(), text.size(), "; %.2f s stolen by the hypervisor", stolen);
  return out + text.data();
}

}  // namespace handrail
