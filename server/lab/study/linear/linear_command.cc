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

// The study as its words have it.
StudyCommand study_of(const LinearCommand& words) {
  std::vector<std::string> settings;
  if (words.smoother == "published") settings.push_back("smoother.form=PUBLISHED");
  if (words.smoother == "low-lag") settings.push_back("smoother.form=LOW_LAG");
  if (!words.smoother.empty() && settings.empty()) {
    settings = {"smoother.form=LENGTH", "smoother.samples=" + words.smoother};
  }
  if (!words.rate.empty()) settings.push_back("haptic.rate_hz=" + words.rate);
  if (words.tool_method == "exact") settings.push_back("guidance.method=EXACT");
  if (words.tool_method == "published") settings.push_back("guidance.method=PUBLISHED");
  StudyCommand out = words;
  out.settings.insert(out.settings.begin(), settings.begin(), settings.end());
  return out;
}

}  // namespace

int run_linear_command(const LinearCommand& words, const std::atomic<bool>& cancelled) {
  const StudyCommand command = study_of(words);
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
