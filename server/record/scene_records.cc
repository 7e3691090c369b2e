#include "server/record/scene_records.h"

#include <utility>

#include "server/record/recorder.h"
#include "server/scene/scene_io.h"

namespace handrail {

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
