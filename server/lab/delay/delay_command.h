// handrail-lab contact-delay: surfaces felt over delay, through the spring and by a local model.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "server/lab/delay/contact_delay.h"

namespace handrail {

struct DelayCommand {
  bool quick = false;  // the edges: 0, 200 and 1000 ms of round trip, and the worst link of all
  bool json = false;
  std::uint64_t seed = 1;  // of networks, hands and arms
  int threads = 0;
};

struct DelayCell {
  DelayCase of;
  DelayFigures figures;
};

// 50 and 1 N/mm; 0, 50, 100, 200, 500, 1000 ms; then jitter and loss, where the jitter is no more
// than the delay; each without and with the local model.
std::vector<DelayCase> delay_cases(bool quick, std::uint64_t seed);
std::string delay_table(const std::vector<DelayCell>& cells);
std::string delay_json(const std::vector<DelayCell>& cells);  // a line a cell

// A LabExit; kFailed where a local model does not do what is asked of it.
int run_delay_command(const DelayCommand& command, const std::atomic<bool>& cancelled);

inline constexpr double kDisplayed = 500.0;  // at the second touch [N/m]
inline constexpr double kDrift = 0.5;        // [mm]
// Asked of every surface: that its force stands still. Of one that is stiffer than kDisplayed at
// the hand, once it is known, so at the second touch, also: kDisplayed at least, no more than
// kDrift of the command while it is held, and none of the tip afterwards.
bool reaches(const DelayCell& cell);

}  // namespace handrail
