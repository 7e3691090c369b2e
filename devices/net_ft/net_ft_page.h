// What a Net F/T sensor's own page says of its scale, from text. No socket.
//
// Source: ATI, Net F/T user manual 9620-05, netftapi2.xml; names of the fields as public drivers
// read them (netft-cpp, ros2_net_ft_driver).
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

struct NetFtPage {
  double counts_per_n = 0.0;    // > 0
  double counts_per_n_m = 0.0;  // > 0
  std::string units;            // as the page has them, "N and N-m"
  bool streams = true;          // RDT is enabled
  int rate_hz = 0;              // of the stream; 0: the page does not say
  unsigned status = 0;          // as in a record; 0: healthy
};

// The error names the field, what it says and what was expected. Units other than N and N m are
// converted.
Result<NetFtPage> parse_net_ft_page(const std::string& xml);

}  // namespace handrail
