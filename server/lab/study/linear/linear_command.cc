#include "server/lab/study/linear/linear_command.h"

#include "server/lab/study/linear/linear_drawing.h"
#include "server/lab/study/linear/linear_fit.h"
#include "server/lab/study/linear/linear_report_io.h"

namespace handrail {
namespace {

Status suits_linear(const StudySetup& setup) {
  const Scene& scene = setup.machine.scene;
  if (scene.task) return Status::ok();
  return Status::error(scene.file + ": the scene has no task block");
}

}  // namespace

int run_linear_command(const StudyCommand& command, const std::atomic<bool>& cancelled) {
  StudyJob<LinearStudy> job;
  job.suits = suits_linear;
  job.run = [](const StudySetup& setup, const StudyPlan& plan) {
    return run_linear_study(setup.machine, setup.population, {plan});
  };
  job.report = command.json ? linear_json : linear_table;
  job.draw = [&](const StudyHeader& header, const LinearStudy& study, const Scene& scene) {
    return draw_linear(command.figures, header, study, *scene.task);
  };
  return run_study_command(command, job, cancelled);
}

int run_linear_fit(const FitCommand& command, const std::atomic<bool>& cancelled) {
  FitJob job;
  job.suits = suits_linear;
  job.mode = name_of(StudyMode::kFree);
  job.known = "published";
  job.aims = linear_aims();
  job.fit = [](const StudySetup& setup, const FitOptions& options) {
    return fit_linear(setup.machine, setup.population, options);
  };
  return run_fit(command, job, cancelled);
}

}  // namespace handrail
