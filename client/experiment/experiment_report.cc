#include <algorithm>
#include <filesystem>
#include <system_error>

#include "client/experiment/experiment_results_io.h"
#include "client/experiment/experiment_run.h"
#include "client/experiment/trace_csv.h"
#include "client/experiment/wall_results_io.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
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

Vec3 vector_at(const std::vector<double>& row, std::size_t first, double unit) {
  return unit * Vec3(row[first], row[first + 1], row[first + 2]);
}

TracePoint linear_point(const std::vector<double>& row) { return {vector_at(row, 0, kMm)}; }

ScrewTracePoint screw_point(const std::vector<double>& row) {
  ScrewTracePoint out;
  out.p_ST = vector_at(row, 0, kMm);
  out.contact = vector_at(row, 3, 1.0);
  out.spring = vector_at(row, 6, 1.0);
  out.time = row[9];
  return out;
}

// The ways of the first person's counted trials, from their CSVs; a file that is not there any more
// leaves its trial without.
template <typename Trial, typename Point>
Status add_traces(const ExperimentWords& words, const ExperimentRecord& person,
                  const std::vector<std::string>& columns,
                  Point (*point)(const std::vector<double>&), std::vector<Trial>& trials) {
  std::size_t counted = 0;
  for (std::size_t i = 0; i < person.trials.size(); ++i) {
    if (person.trials[i].practice() || person.trials[i].interrupted()) continue;
    const std::string file = trace_file(words.folder, words.experiment, person.subject.subject(),
                                        static_cast<int>(i) + 1);
    Trial& trial = trials[counted++];
    if (!std::filesystem::exists(file)) continue;
    const auto rows = read_trace(file, columns);
    if (!rows) return rows.status();
    for (const std::vector<double>& row : *rows) trial.result.trace.push_back(point(row));
  }
  return Status::ok();
}

Status draw(const ExperimentWords& words, const std::string& folder,
            const std::vector<ExperimentRecord>& people) {
  const Result<Scene> scene = SceneLibrary().load(words.experiment);
  if (!scene) return scene.status();
  if (Status s = make_folder(folder); !s) return s;
  std::vector<std::string> columns = {"tip_x_mm", "tip_y_mm", "tip_z_mm"};
  if (scene->screw) {
    for (const char* more : {"force_x_n", "force_y_n", "force_z_n", "spring_x_n", "spring_y_n",
                             "spring_z_n", "time_s"}) {
      columns.emplace_back(more);
    }
    ScrewStudy study = screw_study_of(people);
    if (Status s = add_traces(words, people.front(), columns, screw_point, study.trials); !s)
      return s;
    return draw_screw(folder, header_of(people), study, *scene->simulate->find<HexSocketSpec>());
  }
  if (!scene->task) return draw_wall_results(folder, people);
  LinearStudy study = study_of(people);
  if (Status s = add_traces(words, people.front(), columns, linear_point, study.trials); !s)
    return s;
  return draw_linear(folder, header_of(people), study, *scene->task);
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
  const Status drawn = draw(words, figures, *people);
  return drawn ? kExitDone : problem(drawn.message());
}

}  // namespace handrail
