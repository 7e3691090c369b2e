#include "server/record/recorded_scenes.h"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

Status write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out) return Status::ok();
  return Status::error(path.string() + ": cannot be written: " + std::strerror(errno));
}

// A recording is from anybody: its names are no paths.
bool is_file_stem(const std::string& name) {
  return !name.empty() && name.size() < 48 && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
  });
}

constexpr char kPictureFile[] = "picture.png";

}  // namespace

RecordedScenes::RecordedScenes(std::vector<Override> overrides, std::string instead)
    : overrides_(std::move(overrides)), instead_(std::move(instead)) {}

RecordedScenes::~RecordedScenes() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

Result<Scene> RecordedScenes::load(const pb::RecordedScene& scene) {
  if (!instead_.empty()) return SceneLibrary().load(instead_, overrides_);
  if (folder_.empty()) {
    std::error_code error;
    std::string made = (std::filesystem::temp_directory_path(error) / "handrail-replay.XXXXXX");
    if (error || ::mkdtemp(made.data()) == nullptr) {
      return Status::error(made + ": no folder for the recorded scenes: " + std::strerror(errno));
    }
    folder_ = made;
  }
  if (!is_file_stem(scene.name())) {
    return Status::error("a recorded scene's name, expected letters, digits, '-' and '_'");
  }
  // In a folder of its own: another number may have the same name.
  const auto folder = std::filesystem::path(folder_) / std::to_string(scene.number());
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string text = scene.text();
  if (scene.has_picture()) {
    pb::Scene raw;
    if (!google::protobuf::TextFormat::ParseFromString(text, &raw)) {
      return Status::error("recorded scene " + scene.name() + ": is no scene");
    }
    raw.mutable_walls()->mutable_image()->set_file(kPictureFile);
    google::protobuf::TextFormat::PrintToString(raw, &text);
    if (Status done = write_file(folder / kPictureFile, scene.picture_png()); !done) return done;
  }
  const auto file = folder / (scene.name() + std::string(kSceneExtension));
  if (Status done = write_file(file, text); !done) return done;
  return load_scene_file(file.string(), nullptr, overrides_);
}

Status RecordedScenes::add(const pb::RecordedScene& scene) {
  if (scenes_.contains(scene.number())) return Status::ok();
  Result<Scene> loaded = load(scene);
  if (!loaded) return loaded.status();
  scenes_.emplace(scene.number(), std::move(*loaded));
  return Status::ok();
}

const Scene* RecordedScenes::find(std::uint32_t number) const {
  const auto found = scenes_.find(number);
  return found == scenes_.end() ? nullptr : &found->second;
}

}  // namespace handrail
