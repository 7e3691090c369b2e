// Where scenes are found by name.
#pragma once

#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/model/scene.h"
#include "server/scene/overrides.h"

namespace handrail {

// Folders searched for NAME.scene, in order: those given first, then HANDRAIL_SCENE_PATH (colons
// between folders), then the scenes shipped. A name found in an earlier folder hides later ones.
class SceneLibrary {
 public:
  explicit SceneLibrary(const std::vector<std::string>& first_folders = {});

  // The file of that name. The error lists the folders searched, or says why it is no name.
  Result<std::string> find(const std::string& name) const;
  // find, then load_scene_file.
  Result<Scene> load(const std::string& name, const std::vector<Override>& overrides = {}) const;

  struct Entry {
    std::string name;
    std::string file;
  };
  // Every scene file found, by name; files are not read.
  std::vector<Entry> list() const;

  const std::vector<std::string>& folders() const { return folders_; }

 private:
  std::vector<std::string> folders_;
};

}  // namespace handrail
