#include "client/experiment/experiment_task.h"

#include "client/experiment/gearshift_experiment.h"
#include "client/experiment/linear_experiment.h"
#include "client/experiment/screw_experiment.h"
#include "client/experiment/wrench_experiment.h"

namespace handrail {
namespace {

constexpr const char* kLoosening = "wrench-loosening";

}  // namespace

const std::vector<std::string>& experiment_names() {
  static const std::vector<std::string> names = {"linear-movement", "gearshift", "wrench",
                                                 kLoosening, "screw-fastening"};
  return names;
}

std::string scene_of_experiment(const std::string& experiment) {
  return experiment == kLoosening ? "wrench" : experiment;
}

Result<std::unique_ptr<ExperimentTask>> make_task(const std::string& experiment, const Scene& scene,
                                                  const std::string& rig) {
  if (experiment == "gearshift") {
    Result<GearGate> gate = GearGate::of(scene);
    if (!gate) return gate.status();
    return std::unique_ptr<ExperimentTask>(
        std::make_unique<GearshiftExperiment>(scene, std::move(*gate)));
  }
  if (experiment == "wrench" || experiment == kLoosening) {
    const Result<WrenchPath> path = WrenchPath::of(scene);
    if (!path) return path.status();
    return std::unique_ptr<ExperimentTask>(std::make_unique<WrenchExperiment>(
        scene, *path,
        experiment == kLoosening ? WrenchWay::kTightenAndLoosen : WrenchWay::kTighten));
  }
  if (experiment == "screw-fastening") {
    if (!scene.screw) return Status::error(scene.file + ": the scene has no screw block");
    return std::unique_ptr<ExperimentTask>(std::make_unique<ScrewExperiment>(scene, rig));
  }
  if (!scene.task) return Status::error(scene.file + ": the scene has no task block");
  return std::unique_ptr<ExperimentTask>(std::make_unique<LinearExperiment>(scene));
}

}  // namespace handrail
