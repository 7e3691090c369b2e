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
  std::string link;  // another network; empty: none
  bool no_images = false;
  bool other_processor = false;
  bool json = false;
};

struct JoinCommand {
  std::string first, second;
  std::string out;  // empty: no file is written
  bool json = false;
};

// Exit codes: 0 done, 2 they are no recordings, or do not belong together.
int run_join_command(const JoinCommand& command);

struct RecordingCsvCommand {
  std::string file;
  std::string out;
  double hz = 0.0;       // 0: every tick
  int trial = 0;         // of an experiment, alone; 0: all
  bool packets = false;  // datagrams instead of ticks
};

// Exit codes: 0 done, 1 the table cannot be written, 2 no recording.
int run_recording_csv_command(const RecordingCsvCommand& command);

// Exit codes: 0 as recorded, or what was asked is shown; 1 another result, or the file is damaged;
// 2 no recording, or bad usage; 130 cancelled.
int run_replay_command(const ReplayCommand& command, const std::function<bool()>& cancelled);

}  // namespace handrail
