#include <algorithm>
#include <filesystem>
#include <system_error>

#include "client/experiment/experiment_results_io.h"
#include "client/experiment/experiment_run.h"
#include "client/experiment/wall_results_io.h"
#include "server/base/plain_text.h"
#include "server/lab/study/linear/linear_drawing.h"
#include "server/lab/study/screw/screw_drawing.h"
#include "server/lab/study/study_drawing.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// The files of an experiment in a folder, by name.
Result<std::vector<std::string>> files_in(const std::string& folder,
                                          const std::string& experiment) {
  std::error_code code;
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(experiment + ".") && name.ends_with(kExperimentExtension))
      out.push_back(entry.path().string());
  }
  if (code) return Status::error(shown(folder, 200) + ": cannot be read: " + code.message());
  std::sort(out.begin(), out.end());
  return out;
}

Result<std::vector<ExperimentRecord>> people_of(const ExperimentWords& words) {
  const auto files = files_in(words.folder, words.experiment);
  if (!files) return files.status();
  std::vector<ExperimentRecord> out;
  for (const std::string& file : *files) {
    const Result<ExperimentRecord> record = read_experiment(file);
    if (!record) return record.status();
    if (record->subject.simulated() == words.simulated) out.push_back(*record);
  }
  const auto counted = [](const ExperimentRecord& record) {
    return std::any_of(record.trials.begin(), record.trials.end(),
                       [](const auto& trial) { return !trial.practice() && !trial.interrupted(); });
  };
  if (std::any_of(out.begin(), out.end(), counted)) return out;
  return Status::error(shown(words.folder, 200) + ": no counted trial of " +
                       (words.simulated ? "a simulated subject" : "a person") + " in " +
                       words.experiment);
}

Status draw(const std::string& experiment, const std::string& folder,
            const std::vector<ExperimentRecord>& people) {
  const Result<Scene> scene = SceneLibrary().load(experiment);
  if (!scene) return scene.status();
  if (Status s = make_folder(folder); !s) return s;
  if (scene->screw) {
    return draw_screw(folder, header_of(people), screw_study_of(people),
                      *scene->simulate->find<HexSocketSpec>());
  }
  if (!scene->task) return draw_wall_results(folder, people);
  return draw_linear(folder, header_of(people), study_of(people), *scene->task);
}

}  // namespace

ExitCode report_experiment(const ExperimentWords& words, const std::string& figures,
                           const ExperimentPlace& place) {
  const auto problem = [&](const std::string& text) {
    place.err << "handrail: experiment: " << text << '\n';
    return kExitRefused;
  };
  const auto people = people_of(words);
  if (!people) return problem(people.message());
  place.out << results_text(*people, words.json);
  if (figures.empty()) return kExitDone;
  const Status drawn = draw(words.experiment, figures, *people);
  return drawn ? kExitDone : problem(drawn.message());
}

}  // namespace handrail
