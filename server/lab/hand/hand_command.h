// The lab's command for a recorded hand.
#pragma once

#include <map>
#include <string>

#include "server/lab/hand/hand_run.h"

namespace handrail {

struct HandCommand {
  std::string file;
  std::string tool = "line";  // a key of hand_tools()
  std::string scene = "linear-movement";
  bool one_way = false;
  bool json = false;
};

const std::map<std::string, ToolKind>& hand_tools();

// Exit codes: 0 done, 1 the run could not be made, 2 bad file or usage.
int run_hand_command(const HandCommand& command);

}  // namespace handrail
