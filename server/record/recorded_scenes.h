// The scenes of a recording, loaded anew from the files that it holds.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/record.pb.h"
#include "server/model/scene.h"
#include "server/scene/overrides.h"

namespace handrail {

// Writes them to a folder of its own among the temporary files, and removes it at its end.
class RecordedScenes {
 public:
  // `overrides`: set in every scene that is loaded. `instead`: a scene's name or file in place of
  // all of them; empty: none.
  RecordedScenes(std::vector<Override> overrides, std::string instead);
  ~RecordedScenes();
  RecordedScenes(const RecordedScenes&) = delete;
  RecordedScenes& operator=(const RecordedScenes&) = delete;

  // The error says what of the recorded files cannot be loaded.
  Status add(const pb::RecordedScene& scene);
  // Null: the recording does not have it.
  const Scene* find(std::uint32_t number) const;

 private:
  Result<Scene> load(const pb::RecordedScene& scene);

  std::vector<Override> overrides_;
  std::string instead_;
  std::string folder_;  // empty: not made yet
  std::map<std::uint32_t, Scene> scenes_;
};

}  // namespace handrail
