// Scene files. Behind a zero byte follow words as behind --set, a line each.
#include <google/protobuf/util/json_util.h>

#include <sstream>
#include <string>

#include "server/master/haptic_settings.h"
#include "server/scene/json_io.h"
#include "server/scene/scene_io.h"
#include "server/slave/follow_settings.h"
#include "tests/fuzz/expect_error.h"

namespace handrail {
namespace {

using fuzz::require;

// The file's name is the scene's, or everything would be refused for that.
std::string path_for(std::string_view text) {
  const std::size_t key = text.find("name");
  const std::size_t open = text.find_first_of("\"'\n", key == text.npos ? text.size() : key);
  const std::string folder = HANDRAIL_SOURCE_DIR "/tests/data/walls/";
  if (open == text.npos || text[open] == '\n') return folder + "none.scene";
  const std::string_view rest = text.substr(open + 1);
  std::string name(rest.substr(0, rest.find_first_of("\"'\n/")));
  std::erase_if(name, [](char c) { return c < ' ' || c > '~'; });
  return folder + name + ".scene";
}

std::vector<std::string> lines_of(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line) && lines.size() < 8;) lines.push_back(line);
  return lines;
}

// A scene that passes is whole: both sides can be set up for it, and it can be shown as JSON.
void use(const Scene& scene, const pb::Scene& raw) {
  require(is_scene_name(scene.name), "a scene has a name");
  const HapticSettings haptic = haptic_settings(scene, HapticCapabilities());
  require(haptic.hashes.tools == section_hashes(scene).tools, "both sides hash alike");
  if (!scene.walls) (void)follow_settings(scene, 7'100 * kMicrosecond, true, 1000.0);
  pb::Scene again;
  const auto status = google::protobuf::util::JsonStringToMessage(json_text(raw, false), &again);
  require(status.ok(), "a scene's JSON can be read");
}

}  // namespace

HANDRAIL_FUZZ(scene) {
  const std::string_view all = fuzz::text_of(bytes);
  const std::string_view text = all.substr(0, all.find('\0'));
  const std::string path = path_for(text);
  std::vector<Override> overrides;
  if (text.size() < all.size()) {
    const auto parsed = parse_overrides(lines_of(all.substr(text.size() + 1)));
    if (!parsed) return fuzz::require_error_at("--set ", parsed.message());
    overrides = *parsed;
  }
  pb::Scene raw;
  const Result<Scene> scene = parse_scene(path, text, &raw, overrides);
  if (scene) return use(*scene, raw);
  const bool of_override = scene.message().starts_with("--set ");
  fuzz::require_error_at(of_override ? "--set " : path + ":", scene.message());
}

}  // namespace handrail
