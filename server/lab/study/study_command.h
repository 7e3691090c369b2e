// A study and a fit as the command line runs them, whatever the task.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "server/lab/console/console.h"
#include "server/lab/study/pattern_search.h"
#include "server/lab/study/study_drawing.h"
#include "server/lab/study/study_run.h"
#include "server/lab/study/study_setup_io.h"

namespace handrail {

struct StudyCommand {
  // Scene and population are named as the experiment unless said otherwise.
  explicit StudyCommand(const char* experiment) : scene(experiment), population(experiment) {}

  std::string scene;
  std::string population;
  int operators = 7;
  int trials = 2;
  std::uint32_t seed = 1;
  int threads = 0;  // 0: one a core
  bool json = false;
  std::string figures;                // folder for the SVG files; empty: none
  std::string record;                 // folder for every trial's recording; empty: none
  std::vector<std::string> settings;  // KEY=VALUE, all together one variation
  std::vector<std::string> sweeps;    // KEY=VALUE,VALUE,..., a variation for each value
};

struct FitCommand {
  explicit FitCommand(const char* experiment) : scene(experiment), population(experiment) {}

  std::string scene;
  std::string population;
  int operators = 40;
  std::uint32_t seed = 1001;
  int threads = 0;
  int evaluations = 150;  // at most
  std::string out;        // file to write; empty: the population's own
  bool check = false;     // write nothing; say whether the file is what the fit gives
};

// Whether scene and population have what the study needs; the error names the file.
using Suits = std::function<Status(const StudySetup&)>;

// What differs between studies. `report` gives JSON or tables, as the command asks for; `draw`
// writes into the command's folder.
template <typename Study>
struct StudyJob {
  Suits suits;
  std::function<Result<Study>(const StudySetup&, const StudyPlan&)> run;
  std::function<std::string(const StudyHeader&, const Study&,
                            const std::vector<StudyVariation<Study>>&)>
      report;
  std::function<Status(const StudyHeader&, const Study&, const Scene&)> draw;
};

struct StudyRun {
  std::string setting;  // empty: the study as it is
  StudySetup setup;
};

// The study as it is, then a run for each variation the command asks for. Everything that can be
// wrong with the words is found here.
Result<std::vector<StudyRun>> study_runs(const StudyCommand& command, const Suits& suits);

// Exit codes: 0 done, 1 the run could not be made, 2 bad file or setting, 130 cancelled. Results go
// to the standard output, progress and errors to the error output. `cancelled` is raised from
// outside, as by Ctrl-C.
template <typename Study>
int run_study_command(const StudyCommand& command, const StudyJob<Study>& job,
                      const std::atomic<bool>& cancelled) {
  auto runs = study_runs(command, job.suits);
  if (!runs) return complain(runs.status(), kUsage);
  if (!command.record.empty()) {
    if (Status s = make_folder(command.record); !s) return complain(s, kFailed);
    runs->front().setup.machine.recording.folder = command.record;
  }
  if (!command.figures.empty()) {
    if (Status s = make_folder(command.figures); !s) return complain(s, kFailed);
  }

  Study base;
  std::vector<StudyVariation<Study>> varied;
  Progress progress;
  double simulated = 0.0;
  const auto started = std::chrono::steady_clock::now();
  for (const StudyRun& run : *runs) {
    const bool as_it_is = run.setting.empty();
    StudyPlan plan;
    plan.operators = command.operators;
    plan.trials = command.trials;
    plan.seed = command.seed;
    plan.threads = command.threads;
    plan.traced = as_it_is && !command.figures.empty() ? 1 : 0;
    plan.cancelled = &cancelled;
    const std::string what = as_it_is ? "study" : run.setting;
    plan.progress = [&](std::size_t done) {
      progress.show(what + ": " + std::to_string(done) + " of " +
                    std::to_string(command.operators) + " operators");
    };
    Result<Study> result = job.run(run.setup, plan);
    progress.clear();
    if (!result) return complain(result.status(), cancelled ? kCancelled : kFailed);
    simulated += result->simulated_time;
    if (as_it_is) {
      base = std::move(*result);
    } else {
      varied.push_back({run.setting, std::move(*result)});
    }
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - started;
  if (!command.json) {
    std::fprintf(stderr, "%.0f s of trials in %.1f s: %.0f times as fast as real time\n", simulated,
                 wall.count(), simulated / wall.count());
  }

  const StudySetup& setup = runs->front().setup;
  const StudyHeader header = {command.scene, setup.population.name, command.seed, command.operators,
                              command.trials};
  std::fputs(job.report(header, base, varied).c_str(), stdout);
  if (command.figures.empty()) return kDone;
  const Status drawn = job.draw(header, base, setup.machine.scene);
  return drawn ? kDone : complain(drawn, kFailed);
}

// What differs between fits.
struct FitJob {
  Suits suits;
  const char* mode;          // the one fitted
  const char* known;         // what the aims are: "published"
  std::vector<FitAim> aims;  // in the order of the medians
  std::function<Result<FitResult>(const StudySetup&, const FitOptions&)> fit;
};

// Exit codes as above; with `check` 1 also if the file is not what the fit gives.
int run_fit(const FitCommand& command, const FitJob& job, const std::atomic<bool>& cancelled);

}  // namespace handrail
