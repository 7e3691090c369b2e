// The lab's command that does a recording again.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace handrail {

struct ReplayCommand {
  std::string file;
  std::vector<std::string> set;  // KEY=VALUE
  std::string scene;
  std::string tool;
  bool no_images = false;
  bool json = false;
};

// Exit codes: 0 as recorded, or what was asked is shown; 1 another result, or the file is damaged;
// 2 no recording, or bad usage; 130 cancelled.
int run_replay_command(const ReplayCommand& command, const std::function<bool()>& cancelled);

}  // namespace handrail
