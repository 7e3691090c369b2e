// How late the master's loop is, and how long a tick works, with each driver.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail::desk {

struct LoopPlan {
  int rounds = 10;                   // each device once in each
  double seconds = 3.0;              // of a device in a round
  std::vector<std::string> devices;  // empty: all
};

// Of one device in one round, in the order of the ticks [us].
struct LoopRound {
  std::vector<double> late, work;
  std::uint64_t valid = 0;    // ticks with a valid reading
  std::uint64_t engaged = 0;  // ticks in which the arm was engaged
  std::uint64_t pushed = 0;   // ticks with a force of 0.01 N or more
};

struct LoopSeries {
  std::string device, behind;
  std::string missing;  // why it was not tried; empty: it was
  std::vector<LoopRound> rounds;
};

struct LoopSpread {
  double median = 0.0, most = 0.0, worst = 0.0;  // `most`: 99.9 % [us]
};

// One line of the table.
struct LoopFigures {
  LoopSpread late, work;
  // At 99.9 %, beside the first device's in the same round: the median over the rounds [us].
  double late_grows = 0.0, work_grows = 0.0;
  double valid = 0.0, engaged = 0.0, pushed = 0.0;  // shares of the ticks
};

// Grows by no more than this at 99.9 % [us].
inline constexpr double kMostGrowth = 50.0;

// `series` and `first` have as many rounds, each with a tick at least. Pure.
LoopFigures loop_figures(const LoopSeries& series, const LoopSeries& first);

// The real loop (server/master/haptic_loop.h) in a thread as the master's, with a slave that is
// played, so that it is engaged and renders a line. The devices come in turn, round after round:
// what the computer does beside it meets all of them. `turn` is told what runs next; false: end.
Result<std::vector<LoopSeries>> try_loops(const LoopPlan& plan,
                                          const std::function<bool(const std::string&)>& turn);

}  // namespace handrail::desk
