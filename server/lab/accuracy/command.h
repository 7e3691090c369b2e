// The lab's commands about accuracy and about scenes.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace handrail {

// The choices, as --only takes them.
const std::vector<std::string>& accuracy_choices();

struct AccuracyCommand {
  std::string only;  // one choice; empty: all
  bool json = false;
  std::string figures;  // folder for the SVG files; empty: none
};

struct SceneToolCommand {
  std::string scene;  // name, or a file
  bool json = false;
  std::string out;       // file to write
  std::string accuracy;  // resolve: such as 0.01mm; or
  std::string budget;    // such as 500ns
};

// Exit codes: 0 done, 1 the run could not be made or no setting meets the wish, 2 bad file or
// usage, 130 cancelled. Results go to the standard output, errors to the error output.
int run_accuracy_command(const AccuracyCommand& command, const std::atomic<bool>& cancelled);
int run_explain_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled);
int run_stability_check(const SceneToolCommand& command);
int run_effects_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled);
int run_preview_command(const SceneToolCommand& command);
int run_resolve_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
