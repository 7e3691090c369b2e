#include "server/record/scene_records.h"

#include <filesystem>
#include <utility>

#include "server/base/read_file.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

constexpr std::size_t kMostSceneBytes = std::size_t{1} << 24;  // of a file; as the loaders have it

// A scene as its file has it, with its picture. Nothing is checked but that it can be
// read. May block.
Result<pb::RecordedScene> recorded_scene(const std::string& file, const std::string& picture) {
  const auto text = read_file(file, kMostSceneBytes);
  if (!text) return text.status();
  const std::filesystem::path path(file);
  pb::RecordedScene out;
  out.set_name(path.stem().string());
  out.set_text(*text);
  if (picture.empty()) return out;
  const auto png = read_file((path.parent_path() / picture).string(), kMostSceneBytes);
  if (!png) return png.status();
  out.set_picture(picture);
  out.set_picture_png(*png);
  return out;
}

}  // namespace

Result<Scene> SceneRecords::load(const SceneLibrary& library, const std::string& name) {
  if (!keeps_) return library.load(name);
  const auto file = library.find(name);
  if (!file) return file.status();
  pb::Scene raw;
  Result<Scene> scene = load_scene_file(*file, &raw);
  if (!scene) return scene;
  auto record = recorded_scene(*file, raw.walls().image().file());
  if (!record) return record.status();
  const std::lock_guard lock(mutex_);
  newest_[scene->name] = std::move(*record);
  return scene;
}

pb::RecordedScene SceneRecords::take(const std::string& name, std::uint32_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = newest_.find(name);
  pb::RecordedScene out = found == newest_.end() ? pb::RecordedScene() : found->second;
  out.set_name(name);
  out.set_number(number);
  return out;
}

}  // namespace handrail
