// One setting of one choice: what it gets wrong and what it costs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace handrail {

struct AccuracyRow {
  struct Error {
    std::string unit;
    double rms = 0.0, worst = 0.0;
  };
  struct Cost {
    std::string unit;
    double median = 0.0, p999 = 0.0;
  };
  std::string choice;   // wall, tool_step, smoother, integrator, haptic_rate, link_rate
  std::string method;   // how it is done
  std::string setting;  // how finely, with its unit
  Error error;          // against the exact answer
  Cost cost;
  std::size_t memory_bytes = 0;
  std::string needs;  // what it takes that other rows do not, such as drawn walls; may be empty
  std::string note;   // what the error alone does not say; may be empty
  // Walls: of the proxy from the exact one, with what it stays behind along the wall. Without a
  // unit there is no such difference.
  Error whole;
  const Error& whole_error() const { return whole.unit.empty() ? error : whole; }
};

using AccuracyRows = std::vector<AccuracyRow>;

// Root mean square and largest of errors' sizes.
class ErrorSum {
 public:
  void add(double error) {
    squares_ += error * error;
    worst_ = std::max(worst_, std::abs(error));
    ++count_;
  }
  double rms() const { return count_ == 0 ? 0.0 : std::sqrt(squares_ / count_); }
  double worst() const { return worst_; }
  AccuracyRow::Error in(const char* unit, double per_si) const {
    return {unit, rms() * per_si, worst_ * per_si};
  }

 private:
  double squares_ = 0.0, worst_ = 0.0;
  int count_ = 0;
};

// For each row whether it is efficient: no other of its choice that needs the same has both a
// smaller or equal RMS error and a smaller or equal median cost, one of them smaller. Of equals all
// are.
std::vector<bool> efficient(const AccuracyRows& rows);

}  // namespace handrail
