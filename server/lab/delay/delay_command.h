// handrail-lab contact-delay: surfaces felt over delay, through the spring and by a local model.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "server/lab/delay/contact_delay.h"

namespace handrail {

struct DelayCommand {
  bool quick = false;  // round trips of 0, 200 and 1000 ms, no jitter and loss
  bool json = false;
  int threads = 0;
};

struct DelayCell {
  DelayCase of;
  DelayFigures figures;
};

// 50 and 1 N/mm; 0, 50, 100, 200, 500, 1000 ms; then jitter and loss, where the jitter is no more
// than the delay; each without and with the local model.
std::vector<DelayCase> delay_cases(bool quick);
std::string delay_table(const std::vector<DelayCell>& cells);
std::string delay_json(const std::vector<DelayCell>& cells);  // a line a cell

// A LabExit; kFailed where a local model is not stable, does not reach kDisplayed at the second
// touch, or drifts by more than kDrift.
int run_delay_command(const DelayCommand& command, const std::atomic<bool>& cancelled);

inline constexpr double kDisplayed = 500.0;  // what is aimed at [N/m]
inline constexpr double kDrift = 0.5;        // [mm]
bool reaches(const DelayCell& cell);

}  // namespace handrail
