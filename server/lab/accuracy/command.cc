#include "server/lab/accuracy/command.h"

#include <algorithm>
#include <cstdio>

#include "server/lab/accuracy/choices.h"
#include "server/lab/accuracy/resolve_io.h"
#include "server/lab/accuracy/wall_choice.h"
#include "server/lab/console/console.h"
#include "server/lab/scenes/drawing.h"
#include "server/lab/scenes/effects.h"
#include "server/lab/scenes/explain.h"
#include "server/lab/scenes/preview.h"
#include "server/lab/scenes/report_io.h"
#include "server/lab/scenes/stability.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// A scene's file from its name, or the file itself when the word looks like one.
Result<std::string> file_of(const std::string& word) {
  const bool is_file = word.find('/') != std::string::npos || word.ends_with(kSceneExtension);
  if (is_file) return word;
  return SceneLibrary().find(word);
}

Result<Scene> scene_of(const std::string& word) {
  const Result<std::string> file = file_of(word);
  if (!file) return file.status();
  return load_scene_file(*file);
}

AccuracyRows rows_of(const std::string& choice, const std::atomic<bool>& cancelled) {
  if (choice == "wall") return wall_rows(wall_settings(), cancelled);
  if (choice == "tool_step") return tool_rows(cancelled);
  if (choice == "smoother") return smoother_rows();
  if (choice == "integrator") return integrator_rows(cancelled);
  if (choice == "haptic_rate") return rate_rows(cancelled);
  return link_rows(cancelled);
}

}  // namespace

const std::vector<std::string>& accuracy_choices() {
  static const std::vector<std::string> choices = {"wall",       "tool_step",   "smoother",
                                                   "integrator", "haptic_rate", "link_rate"};
  return choices;
}

int run_accuracy_command(const AccuracyCommand& command, const std::atomic<bool>& cancelled) {
  AccuracyRows rows;
  for (const std::string& choice : accuracy_choices()) {
    if (!command.only.empty() && command.only != choice) continue;
    const AccuracyRows more = rows_of(choice, cancelled);
    if (cancelled) return complain(Status::error("cancelled"), kCancelled);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  const std::string text = command.json ? accuracy_json(rows) : accuracy_table(rows);
  std::fputs(text.c_str(), stdout);
  if (command.figures.empty()) return kDone;
  const Status drawn = draw_accuracy(command.figures, rows);
  return drawn ? kDone : complain(drawn, kFailed);
}

int run_explain_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled) {
  const Result<Scene> scene = scene_of(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  const Result<Explanation> explained = explain_scene(*scene, cancelled);
  if (!explained) return complain(explained.status(), kCancelled);
  const std::string text =
      command.json ? explanation_json(*explained) : explanation_table(*explained);
  std::fputs(text.c_str(), stdout);
  return kDone;
}

int run_stability_check(const SceneToolCommand& command) {
  const Result<Scene> scene = scene_of(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  const std::string text = command.json ? stability_json(*scene) : stability_text(*scene);
  std::fputs(text.c_str(), stdout);
  return kDone;
}

int run_effects_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled) {
  const Result<Scene> scene = scene_of(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  const Result<EffectRows> rows = effects_in_turn(*scene, cancelled);
  if (!rows) return complain(rows.status(), cancelled ? kCancelled : kUsage);
  const std::string text = command.json ? effects_json(*rows) : effects_table(*rows);
  std::fputs(text.c_str(), stdout);
  return kDone;
}

int run_preview_command(const SceneToolCommand& command) {
  const Result<Scene> scene = scene_of(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  const Result<Canvas> canvas = preview_scene(*scene);
  if (!canvas) return complain(canvas.status(), kUsage);
  if (const Status s = canvas->write_png(command.out); !s) return complain(s, kFailed);
  std::printf(
      "%s: walls; blue: force on a hand at rest, its square root as length; grey: a hand that "
      "wanders; orange: its proxy; green: start\n",
      command.out.c_str());
  return kDone;
}

int run_resolve_command(const SceneToolCommand& command, const std::atomic<bool>& cancelled) {
  const Result<AccuracyWish> wish = accuracy_wish(command.accuracy, command.budget);
  if (!wish) return complain(wish.status(), kUsage);
  const Result<std::string> file = file_of(command.scene);
  if (!file) return complain(file.status(), kUsage);
  if (const Result<Scene> scene = load_scene_file(*file); !scene) {
    return complain(scene.status(), kUsage);
  }
  const Result<Resolved> resolved = resolve_scene(*file, *wish, command.out, cancelled);
  if (!resolved) return complain(resolved.status(), cancelled ? kCancelled : kFailed);
  std::printf("%s%s\nwritten: %s\n", accuracy_table(resolved->rows).c_str(), resolved->why.c_str(),
              command.out.c_str());
  return kDone;
}

}  // namespace handrail
