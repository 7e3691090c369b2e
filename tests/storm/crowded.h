// Stops, and how late the control loops are, while logs and a disk are stuck and a thousand
// clients crowd in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace handrail::storm {

constexpr int kPairs = 10;
constexpr int kFewestPairs = 6;   // that have an interval
constexpr int kMostPairs = 1000;  // six hours

struct CrowdedOptions {
  int stops = 1000;    // under the crowd, and as many without; of all windows together
  int pairs = kPairs;  // of windows, [kFewestPairs, kMostPairs]
  std::uint64_t seed = 1;
};

// One start of all programs.
struct CrowdedWindow {
  bool crowded = false;
  bool disk_held = false;  // the master waited all the time for a scene from a disk
  double haptic_us = 0.0;  // p99.9 of how late the haptic loop's ticks began
  double bare_us = 0.0;    // the same of a loop beside it that does nothing: the machine's share
  double robot_us = 0.0;   // p99.9 of when the controller got the robot loop's command, after its
                           // cycle had begun
  // From before the operator connects. On its wire to the slave, in what the slave says of itself,
  // and in the operator's hands [ms].
  std::vector<double> sent_ms, taken_ms, answered_ms;
  std::uint64_t acts = 0, answers = 0;  // of the crowd, and to it
  std::uint64_t cycles = 0;             // of the controller, with a command
};

struct CrowdedOutcome {
  bool complete = false;  // false: it was interrupted
  std::string problem;    // empty: it ran to its end
  bool realtime = false;  // this program's clock was not kept waiting by others
  std::vector<CrowdedWindow> windows;
};

// Windows of at least 10 s, without the crowd and with it in turn. `interrupted` is asked every
// few milliseconds; `progress` is told before each window.
CrowdedOutcome run_crowded(const CrowdedOptions& options, bool (*interrupted)(),
                           void (*progress)(int window, int of));

// What the windows show.
struct CrowdedFigures {
  struct Times {
    std::size_t count = 0;
    double median = 0.0, p99 = 0.0, p999 = 0.0, worst = 0.0;
  };
  // With the crowd less without it, pair by pair: the median, and the exact interval that has it
  // with at least 95 % (that of the sign test, between two of the differences); endless when there
  // are too few pairs [us].
  struct Growth {
    double median = 0.0, low = 0.0, high = 0.0;
  };
  Times sent, taken, answered, calm_taken;  // [ms]
  Growth haptic, bare, robot;
  bool disk_held = false;  // in every window with the crowd
  std::uint64_t acts = 0, answers = 0;

  bool reached() const;
};
constexpr int kCrowd = 1000;  // clients
// The smallest value that so large a share is not above; 0 of none.
double at_share(std::vector<double> values, double share);
CrowdedFigures figures_of(const std::vector<CrowdedWindow>& windows);
std::string for_people(const CrowdedOutcome& outcome);
std::string to_json(const CrowdedOptions& options, const CrowdedOutcome& outcome);

}  // namespace handrail::storm
