#include "server/lab/study/screw/screw_command.h"

#include "server/lab/study/screw/screw_drawing.h"
#include "server/lab/study/screw/screw_fit.h"
#include "server/lab/study/screw/screw_report_io.h"

namespace handrail {
namespace {

Status suits_screw(const StudySetup& setup) {
  const Scene& scene = setup.machine.scene;
  if (!scene.screw) return Status::error(scene.file + ": the scene has no screw block");
  if (setup.population.knows_screws()) return Status::ok();
  return Status::error(setup.population.file + ": no people at a screw: parameters are missing");
}

}  // namespace

int run_screw_command(const ScrewCommand& command, const std::atomic<bool>& cancelled) {
  StudyJob<ScrewStudy> job;
  job.suits = suits_screw;
  job.run = [&](const StudySetup& setup, const StudyPlan& plan) {
    return run_screw_study(setup.machine, setup.population, {plan, command.bumper});
  };
  job.report = [&](const StudyHeader& header, const ScrewStudy& study,
                   const std::vector<ScrewVariation>& variations) {
    const auto report = command.json ? screw_json : screw_table;
    return report(header, command.bumper, study, variations);
  };
  job.draw = [&](const StudyHeader& header, const ScrewStudy& study, const Scene& scene) {
    return draw_screw(command.figures, header, study, *scene.simulate->find<HexSocketSpec>());
  };
  return run_study_command(command, job, cancelled);
}

int run_screw_fit(const FitCommand& command, const std::atomic<bool>& cancelled) {
  FitJob job;
  job.suits = suits_screw;
  job.mode = name_of(ScrewMode::kNCNV);
  job.known = "implied";
  job.aims = screw_aims();
  job.fit = [](const StudySetup& setup, const FitOptions& options) {
    return fit_screw(setup.machine, setup.population, options);
  };
  return run_fit(command, job, cancelled);
}

}  // namespace handrail
