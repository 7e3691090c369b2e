// What `handrail robot on|off|reset|status` does: the controller's own switches.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

#include "client/api/operator_client.h"

namespace handrail {

enum class RobotOrder : std::uint8_t { kOn, kOff, kReset, kStatus };

// What was typed.
struct RobotWords {
  RobotOrder order = RobotOrder::kStatus;
  std::string slave_config;                  // file; empty: its defaults
  std::optional<std::string> override_text;  // of --override
  bool json = false;
};

struct RobotPlace {
  MasterPlace master;  // asked whether the slave holds a stop
  std::string as;
  std::ostream& out;
  std::ostream& err;
  bool (*interrupted)();
};

// kExitDone: it was done, or with kStatus told; kExitRefused: not, and why; kExitUsage: a wrong
// file or word; kExitInterrupted: broken off, and what was begun was taken back.
ExitCode run_robot_order(const RobotWords& words, const RobotPlace& place);

}  // namespace handrail
