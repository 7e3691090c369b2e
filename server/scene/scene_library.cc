#include "server/scene/scene_library.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/base/plain_text.h"
#include "server/scene/scene_io.h"
#include "server/scene/shipped.h"

namespace handrail {
namespace fs = std::filesystem;

SceneLibrary::SceneLibrary(const std::vector<std::string>& first_folders)
    : folders_(first_folders) {
  if (const char* path = std::getenv("HANDRAIL_SCENE_PATH"); path != nullptr) {
    std::istringstream parts(path);
    for (std::string folder; std::getline(parts, folder, ':');) {
      if (!folder.empty()) folders_.push_back(folder);
    }
  }
  for (std::string& folder : shipped_folders(HANDRAIL_SCENE_LIBRARY, "scenes")) {
    folders_.push_back(std::move(folder));
  }
}

Result<std::string> SceneLibrary::find(const std::string& name) const {
  if (!is_scene_name(name)) {
    return Status::error("scene '" + shown(name) +
                         "': expected 1 to 47 letters, digits, '-' and '_'");
  }
  std::string searched;
  for (const std::string& folder : folders_) {
    const fs::path file = fs::path(folder) / (name + std::string(kSceneExtension));
    std::error_code error;
    if (fs::exists(file, error)) return file.string();
    searched += (searched.empty() ? "" : ", ") + folder;
  }
  std::vector<std::string> names;
  for (const Entry& entry : list()) names.push_back(entry.name);
  const std::string nearest = nearest_name(name, names);
  return Status::error("scene '" + name + "' not found in " + searched + "; " +
                       (nearest.empty() ? std::string("'handrail scene list' names them all")
                                        : "did you mean '" + nearest + "'?"));
}

Result<Scene> SceneLibrary::load(const std::string& name,
                                 const std::vector<Override>& overrides) const {
  const Result<std::string> file = find(name);
  if (!file) return file.status();
  return load_scene_file(*file, nullptr, overrides);
}

std::vector<SceneLibrary::Entry> SceneLibrary::list() const {
  std::map<std::string, std::string> found;
  for (const std::string& folder : folders_) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      if (it->path().extension() != kSceneExtension) continue;
      found.emplace(it->path().stem().string(), it->path().string());
    }
  }
  std::vector<Entry> out;
  for (const auto& [name, file] : found) out.push_back({name, file});
  return out;
}

}  // namespace handrail
