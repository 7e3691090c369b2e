// What the slave's log says of its robot controller.
#pragma once

#include <cctype>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "server/model/reason.h"

namespace handrail {

// One line for each kind of problem when it begins, and one when the controller is there.
class ConnectionWatch {
 public:
  struct Line {
    bool bad = false;  // somebody should look
    std::string text;
  };

  explicit ConnectionWatch(std::string robot) : robot_(std::move(robot)) {}

  // `problem`: why there is no connection; empty: it has not been tried, or is there. `lost`: it
  // was there, and is tried again only after a reset. `fault`: of the session, which has a line of
  // its own. Allocates when there is something to say.
  std::optional<Line> step(bool connected, bool lost, std::string_view problem, Reason fault) {
    if (connected) {
      said_.clear();
      last_.clear();
      if (std::exchange(connected_, true)) return std::nullopt;
      return Line{false, "connected to " + robot_};
    }
    const bool gone = std::exchange(connected_, false);
    if (gone && fault != Reason::kRobotLost) {
      return Line{true, std::string(describe(Reason::kRobotLost)) + "; " + kResetTries};
    }
    if (problem.empty() || problem == last_) return std::nullopt;
    last_ = problem;
    if (!said_.insert(kind_of(last_)).second) return std::nullopt;
    return Line{true, last_ + "; " + (lost ? kResetTries : "trying again")};
  }

  static constexpr const char* kResetTries = "a reset tries to connect again";

 private:
  // Counts and angles are other ones at each try.
  static std::string kind_of(std::string problem) {
    std::erase_if(problem, [](unsigned char c) { return std::isdigit(c) != 0 || c == '-'; });
    return problem;
  }

  std::string robot_, last_;
  std::set<std::string> said_;  // kinds, since it was connected last
  bool connected_ = false;
};

}  // namespace handrail
