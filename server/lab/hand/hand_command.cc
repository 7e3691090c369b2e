#include "server/lab/hand/hand_command.h"

#include <cstdio>

#include "devices/hand/recorded_hand_io.h"
#include "server/lab/console/console.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

void print_json(const HandRunResult& r) {
  std::printf(
      "{\"samples\": %zu, \"gaps\": %zu, \"max_off_tool_mm\": %.9g, \"backward_steps\": %llu, "
      "\"max_joint_speed_ratio\": %.9g, \"max_force_n\": %.9g, \"non_finite\": %llu}\n",
      r.samples, r.gaps, r.max_off_tool / kMm, static_cast<unsigned long long>(r.backward_steps),
      r.max_joint_speed_ratio, r.max_force, static_cast<unsigned long long>(r.non_finite));
}

void print_table(const HandCommand& command, const HandRunResult& r) {
  std::printf("%s on a %s%s, scene %s, simulated arm\n", command.file.c_str(),
              command.one_way ? "one-way " : "", command.tool.c_str(), command.scene.c_str());
  std::printf("  samples                       %zu\n", r.samples);
  std::printf("  gaps bridged                  %zu\n", r.gaps);
  std::printf("  furthest off the tool         %.6f mm\n", r.max_off_tool / kMm);
  std::printf("  backward steps                %llu\n",
              static_cast<unsigned long long>(r.backward_steps));
  std::printf("  fastest joint                 %.4f of Table 3.1\n", r.max_joint_speed_ratio);
  std::printf("  largest force on the hand     %.3f N\n", r.max_force);
  std::printf("  values not finite             %llu\n",
              static_cast<unsigned long long>(r.non_finite));
}

}  // namespace

const std::map<std::string, ToolKind>& hand_tools() {
  static const std::map<std::string, ToolKind> tools = {
      {"point", ToolKind::kPoint}, {"line", ToolKind::kLine}, {"plane", ToolKind::kPlane}};
  return tools;
}

int run_hand_command(const HandCommand& command) {
  const auto scene = SceneLibrary().load(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  const auto motion = load_recorded_motion(command.file);
  if (!motion) return complain(motion.status(), kUsage);
  HandRunOptions options;
  options.tool = hand_tools().at(command.tool);
  options.one_way = command.one_way;
  const auto result = run_hand(*scene, *motion, options);
  if (!result) return complain(result.status(), kFailed);
  if (command.json) {
    print_json(*result);
  } else {
    print_table(command, *result);
  }
  return kDone;
}

}  // namespace handrail
