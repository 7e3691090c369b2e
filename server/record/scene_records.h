// The files of the scenes that a daemon has loaded, until it says under which number it runs them.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "proto/record.pb.h"
#include "server/model/scene.h"
#include "server/scene/scene_library.h"

namespace handrail {

// From any thread.
class SceneRecords {
 public:
  // `keeps`: somebody records; else nothing is read but what a scene needs.
  explicit SceneRecords(bool keeps) : keeps_(keeps) {}

  // As SceneLibrary::load; keeps the file and its picture. May block.
  Result<Scene> load(const SceneLibrary& library, const std::string& name);
  // The newest of that name.
  pb::RecordedScene take(const std::string& name, std::uint32_t number) const;

 private:
  const bool keeps_;
  mutable std::mutex mutex_;
  std::map<std::string, pb::RecordedScene> newest_;
};

}  // namespace handrail
