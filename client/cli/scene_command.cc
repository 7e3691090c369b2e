#include "client/cli/scene_command.h"

#include <google/protobuf/struct.pb.h>

#include <algorithm>
#include <filesystem>
#include <iomanip>

#include "client/cli/json_text.h"
#include "client/cli/scene_view.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// A scene's file from its name, or the file itself when the argument looks like one.
Result<std::string> file_of(const std::string& word) {
  const bool is_file = word.find('/') != std::string::npos || word.ends_with(kSceneExtension);
  if (is_file) return word;
  return SceneLibrary().find(word);
}

void add_text(google::protobuf::Struct& entry, const char* key, const std::string& text) {
  (*entry.mutable_fields())[key].set_string_value(text);
}

}  // namespace

ExitCode run_scene_list(const Options& options, const Console& console) {
  const std::vector<SceneLibrary::Entry> entries = SceneLibrary().list();
  std::size_t width = 4;
  for (const auto& entry : entries) width = std::max(width, entry.name.size());
  google::protobuf::ListValue list;
  for (const auto& [name, file] : entries) {
    const Result<Scene> scene = load_scene_file(file);
    const std::string description = scene ? scene->description : std::string();
    if (options.json) {
      google::protobuf::Struct& entry = *list.add_values()->mutable_struct_value();
      add_text(entry, "name", name);
      add_text(entry, "file", file);
      add_text(entry, "description", description);
      add_text(entry, "error", scene.message());
      (*entry.mutable_fields())["valid"].set_bool_value(scene.is_ok());
    } else {
      console.out << std::left << std::setw(static_cast<int>(width) + 2) << name
                  << (scene ? description : "INVALID  " + scene.message()) << '\n';
    }
  }
  if (options.json) console.out << json_text(list, true) << '\n';
  return kExitDone;
}

ExitCode run_scene_show(const Options& options, const Console& console) {
  const Result<std::string> file = file_of(*options.word);
  if (!file) return complain(console, file.message());
  pb::Scene raw;
  const Result<Scene> scene = load_scene_file(*file, &raw);
  if (!scene) return complain(console, scene.message());
  if (options.json) {
    console.out << json_text(with_sections(raw), true) << '\n';
  } else {
    console.out << *file << '\n' << scene_text(raw);
  }
  return kExitDone;
}

ExitCode run_scene_check(const Options& options, const Console& console) {
  const Result<std::string> file = file_of(*options.word);
  if (!file) return complain(console, file.message());
  const Result<Scene> scene = load_scene_file(*file);
  if (!scene) return complain(console, scene.message());
  for (const std::string& warning : warnings_of(*scene)) {
    console.err << *file << ": warning: " << warning << '\n';
  }
  console.out << *file << ": ok\n";
  return kExitDone;
}

ExitCode run_scene_load(const Options& options, const Console& console) {
  if (!is_scene_name(*options.word)) {
    return complain(console, "scene load: '" + *options.word +
                                 "': expected a scene's name such as linear-movement; master and "
                                 "slave each load their own file of that name");
  }
  pb::Request request;
  request.set_scene_load(*options.word);
  return send_order(options, console, request, "scene " + *options.word + " loaded");
}

}  // namespace handrail
