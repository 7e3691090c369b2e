// handrail-lab: experiments in virtual time, with the daemons' own steps.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <string>

#include "devices/hand/recorded_hand_io.h"
#include "server/lab/hand_run.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

struct HandCommand {
  std::string file;
  std::string tool = "line";
  std::string scene = "linear-movement";
  bool one_way = false;
  bool json = false;
};

const std::map<std::string, ToolKind> kTools = {
    {"point", ToolKind::kPoint}, {"line", ToolKind::kLine}, {"plane", ToolKind::kPlane}};

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

// 0 done, 1 the run could not be made, 2 bad file or usage.
int run_hand_command(const HandCommand& command) {
  const auto scene = SceneLibrary().load(command.scene);
  if (!scene) {
    std::fprintf(stderr, "handrail-lab: %s\n", scene.message().c_str());
    return 2;
  }
  const auto motion = load_recorded_motion(command.file);
  if (!motion) {
    std::fprintf(stderr, "handrail-lab: %s\n", motion.message().c_str());
    return 2;
  }
  HandRunOptions options;
  options.tool = kTools.at(command.tool);
  options.one_way = command.one_way;
  const auto result = run_hand(*scene, *motion, options);
  if (!result) {
    std::fprintf(stderr, "handrail-lab: %s\n", result.message().c_str());
    return 1;
  }
  if (command.json) {
    print_json(*result);
  } else {
    print_table(command, *result);
  }
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{
      "Experiments in virtual time: the same master and slave steps as the daemons, "
      "without sockets or sleeping, bit-identical for the same input."};
  app.require_subcommand(1);

  HandCommand hand;
  CLI::App* hand_app = app.add_subcommand("hand", "drive the simulated arm by a recorded hand");
  hand_app->add_option("FILE", hand.file, "CSV: t_s,x_mm,y_mm[,z_mm]")->required();
  hand_app->add_option("--tool", hand.tool, "tool to hold on to")
      ->check(CLI::IsMember(kTools))
      ->capture_default_str();
  hand_app->add_option("--scene", hand.scene, "scene to run in")->capture_default_str();
  hand_app->add_flag("--one-way", hand.one_way, "forward along device +X only");
  hand_app->add_flag("--json", hand.json, "print the result as JSON");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run_hand_command(hand);
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) { return handrail::run(argc, argv); }
