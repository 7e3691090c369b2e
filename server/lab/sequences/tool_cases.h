// Named cases of tools and orientations: what the hand feels and the arm is told, and where it
// ends.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "server/lab/sequences/bounds.h"

namespace handrail {

// One case: the worst shares of the bounds of bounds.h, and what came of it with the hand at rest
// for ten seconds after all easing had ended.
struct ToolCase {
  std::string name;
  std::array<Judged, kBounds> worst{};
  double drift = 0.0;        // of the command [m]
  double drift_angle = 0.0;  // [rad]
  double off_tool = 0.0;     // of the command from the position tool [m]
  double energy = 0.0;       // given to the hand, and held against it by the governor [J]
  double settled = 0.0;      // time until all easing had ended [s]
  std::string failure;       // what was not as it must be; empty: nothing
};

// Of two tools, each order, called 5 and 50 mm away with a hand that stands up to 90 degrees
// turned: called, refused, or approached.
std::vector<ToolCase> tool_change_cases();
// N- and F-rotation called, and dropped, with the hand turned by nothing, a hair, a quarter and
// half a turn; and trembling there.
std::vector<ToolCase> turned_hand_cases();
// Axes that nearly coincide, or nearly oppose each other.
std::vector<ToolCase> parallel_axis_cases();
// The mean of orientations, of hands that turn past half a turn, slowly, fast and at once.
std::vector<ToolCase> half_turn_cases();

// All of them, in this order, whatever `threads` (0: one a core). Empty when cancelled.
std::vector<ToolCase> run_tool_cases(
    int threads, const std::atomic<bool>& cancelled,
    const std::function<void(std::size_t done, std::size_t of)>& progress = {});

std::size_t failures_of(const std::vector<ToolCase>& cases);
std::string tool_cases_table(const std::vector<ToolCase>& cases);
std::string tool_cases_json(const std::vector<ToolCase>& cases);

}  // namespace handrail
