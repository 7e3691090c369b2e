// A simulated trial as the daemons would have recorded it, with the marks of an experiment.
#pragma once

#include <fstream>
#include <memory>
#include <string>

#include "server/base/status.h"
#include "server/lab/replay/cell_recording.h"

namespace handrail {

namespace pb {
class Scene;
}

struct StudyMachine;

// Where the trials of a study are recorded, and what they run.
struct StudyRecording {
  std::string folder;  // exists; empty: nowhere
  // The scene's file with all that is asked to be otherwise in it.
  std::string scene_text;
};

class TrialRecording {
 public:
  // Nothing of that trial is in the folder yet, or the error names it.
  static Status is_new(const std::string& folder, const std::string& trial);
  // From the cell's first tick on. `trial`: what stands in the marks, EXPERIMENT MODE SUBJECT
  // NUMBER; with '-' for spaces the name of the two files, NAME.master.mcap and NAME.slave.mcap.
  TrialRecording(Cell& cell, const StudyMachine& machine, const std::string& trial);

  // After every tick.
  void pull() { recording_->pull(); }
  // The last. The error names the file that could not be written.
  Status finish(const std::string& end);

 private:
  std::string trial_, name_;
  std::ofstream master_, slave_;
  std::unique_ptr<CellRecording> recording_;
};

// A scene as its file would have it.
std::string scene_file_text(const pb::Scene& scene);

// The same text without contact protection, as set_protection() has it.
std::string text_without_protection(const std::string& text);

}  // namespace handrail
