// What the suite of stability runs, and what a run came to.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace handrail {

// One figure with its unit in its name. Judged ones hold where `value` is at most `most`.
struct CaseFigure {
  const char* name = "";
  double value = 0.0;
  double most = 0.0;
  bool judged = false;

  bool holds() const noexcept { return !judged || value <= most; }  // not for a NaN
};

inline CaseFigure judged(const char* name, double value, double most) {
  return {name, value, most, true};
}
inline CaseFigure told(const char* name, double value) { return {name, value, 0.0, false}; }

using CaseFigures = std::vector<CaseFigure>;

inline bool all_hold(const CaseFigures& figures) {
  for (const CaseFigure& f : figures) {
    if (!f.holds()) return false;
  }
  return true;
}

// It did not come to be, and rightly: neither does it hold nor fail.
struct Refused {
  std::string why;
};

struct CaseOutcome {
  CaseOutcome() = default;
  CaseOutcome(CaseFigures of, std::string what = {})
      : figures(std::move(of)), note(std::move(what)) {}
  CaseOutcome(Refused of) : refused(std::move(of.why)) {}

  CaseFigures figures;
  std::string refused;  // why; empty: it was not
  std::string note;     // beside the figures, such as why an engagement ended
};

// Which runs of the suite have a case.
enum class CaseSize : std::uint8_t {
  kSmall,  // all, with as many seeds as they have
  kLarge,  // all, with a seed unless more are asked for
  kFull,   // the same, and not the quick ones
  kDay,    // the same, and a seed however many are asked for
};

struct StabilityCase {
  // family/...; the last part of a cell of walls is off, energy or on.
  std::string name;
  // False: whether it holds is information, as of a wall without a governor.
  bool must_hold = true;
  bool drawn = false;  // another seed is another run
  std::function<CaseOutcome(std::uint64_t seed)> run;
  CaseSize size = CaseSize::kSmall;

  std::string family() const { return name.substr(0, name.find('/')); }
};

// What theory and published tables say of a plain sampled spring.
std::vector<StabilityCase> truth_cases();
// Whether the master's own wall is such a spring, without a governor.
std::vector<StabilityCase> rendered_cases();
// The walls and effects of the master's own step.
std::vector<StabilityCase> wall_cases();
// The force of position tools, and of a surface that is touched.
std::vector<StabilityCase> guidance_cases();
// The torque of orientation tools.
std::vector<StabilityCase> turn_cases();
// Both sides, the link and the arm, in free space and in contact.
std::vector<StabilityCase> teleop_cases();
// The same where the arm's poses are singular and where its joints' ranges end.
std::vector<StabilityCase> arm_cases();
// A day, and counters near their ends. `cancelled`, if any, outlives the cases: raised, a run of a
// day ends soon, and what it came to says nothing.
std::vector<StabilityCase> long_cases(const std::atomic<bool>* cancelled = nullptr);

}  // namespace handrail
