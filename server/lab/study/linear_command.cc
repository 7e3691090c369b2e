#include "server/lab/study/linear_command.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

#include "server/lab/console.h"
#include "server/lab/study/linear_drawing.h"
#include "server/lab/study/linear_fit.h"
#include "server/lab/study/linear_report_io.h"
#include "server/lab/study/population_io.h"
#include "server/lab/study/study_setup_io.h"
#include "server/scene/text_io.h"

namespace handrail {
namespace {

// The variations a command asks for: what each sets beside nothing else.
Result<std::vector<std::vector<std::string>>> variations_of(const LinearCommand& command) {
  std::vector<std::vector<std::string>> out;
  if (!command.settings.empty()) out.push_back(command.settings);
  for (const std::string& sweep : command.sweeps) {
    const std::size_t equals = sweep.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == sweep.size()) {
      return Status::error("--sweep " + sweep + ": expected KEY=VALUE,VALUE,...");
    }
    const std::string key = sweep.substr(0, equals + 1);
    for (std::size_t at = equals + 1; at <= sweep.size();) {
      const std::size_t comma = std::min(sweep.find(',', at), sweep.size());
      out.push_back({key + sweep.substr(at, comma - at)});
      at = comma + 1;
    }
  }
  return out;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

Status write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  return file ? Status::ok() : Status::error(path + ": cannot write");
}

}  // namespace

int run_linear_command(const LinearCommand& command, const std::atomic<bool>& cancelled) {
  // Everything that can be wrong with the words is found before anything runs.
  const auto variations = variations_of(command);
  if (!variations) return complain(variations.status(), kUsage);
  std::vector<std::vector<std::string>> runs = {{}};
  runs.insert(runs.end(), variations->begin(), variations->end());
  std::vector<StudySetup> setups;
  for (const auto& settings : runs) {
    auto setup = study_setup(command.scene, command.population, settings);
    if (!setup) return complain(setup.status(), kUsage);
    setups.push_back(std::move(*setup));
  }

  if (!command.figures.empty()) {
    if (Status s = make_folder(command.figures); !s) return complain(s, kFailed);
  }

  StudyResult base;
  std::vector<StudyVariation> varied;
  Progress progress;
  double simulated = 0.0;
  const auto started = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    StudyOptions options;
    options.operators = command.operators;
    options.trials = command.trials;
    options.seed = command.seed;
    options.threads = command.threads;
    options.traced = i == 0 && !command.figures.empty() ? 1 : 0;
    options.cancelled = &cancelled;
    const std::string what = i == 0 ? "study" : joined(runs[i]);
    options.progress = [&](std::size_t done) {
      progress.show(what + ": " + std::to_string(done) + " of " +
                    std::to_string(command.operators) + " operators");
    };
    auto result = run_linear_study(setups[i].machine, setups[i].population, options);
    if (!result) return complain(result.status(), cancelled ? kCancelled : kFailed);
    simulated += result->simulated_time;
    if (i == 0) {
      base = std::move(*result);
    } else {
      varied.push_back({joined(runs[i]), std::move(*result)});
    }
  }
  progress.clear();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - started;
  if (!command.json) {
    std::fprintf(stderr, "%.0f s of trials in %.1f s: %.0f times as fast as real time\n", simulated,
                 wall.count(), simulated / wall.count());
  }

  StudyHeader header;
  header.scene = command.scene;
  header.population = setups[0].population.name;
  header.seed = command.seed;
  header.operators = command.operators;
  header.trials = command.trials;
  const std::string text =
      command.json ? linear_json(header, base, varied) : linear_table(header, base, varied);
  std::fputs(text.c_str(), stdout);
  if (command.figures.empty()) return kDone;
  const Status drawn = draw_linear(command.figures, header, base, *setups[0].machine.scene.task);
  return drawn ? kDone : complain(drawn, kFailed);
}

int run_fit_command(const FitCommand& command, const std::atomic<bool>& cancelled) {
  const auto setup = study_setup(command.scene, command.population, {});
  if (!setup) return complain(setup.status(), kUsage);
  FitOptions options;
  options.operators = command.operators;
  options.seed = command.seed;
  options.threads = command.threads;
  options.cancelled = &cancelled;
  Progress progress;
  options.progress = [&](int evaluation, double misfit) {
    char text[96];
    std::snprintf(text, sizeof text, "fit: candidate %d, misfit %.3f", evaluation, misfit);
    progress.show(text);
  };
  const auto fit = fit_linear(setup->machine, setup->population, options);
  if (!fit) return complain(fit.status(), cancelled ? kCancelled : kFailed);
  progress.clear();

  std::printf("%d candidates, %d operators, seed %u; mode NV alone\n", fit->evaluations,
              command.operators, command.seed);
  for (int i = 0; i < kPublishedFigures; ++i) {
    const LinearFigureInfo& info = info_of(static_cast<LinearFigure>(i));
    std::printf("  %-28s %8.3g %s, published %.4g\n", info.title,
                fit->medians[static_cast<std::size_t>(i)] * info.per_si, info.unit,
                info.published[0]);
  }
  for (const ParameterRange& parameter : fit->population.parameters) {
    if (!parameter.fitted) continue;
    std::printf("  %-28s %8.3g (%.3g to %.3g)\n", parameter.name, parameter.median / parameter.unit,
                parameter.low / parameter.unit, parameter.high / parameter.unit);
  }
  const std::string text = to_text(fit->population);
  if (command.check) {
    const auto file = read_file(setup->population.file, TextSource::kMaxBytes);
    const bool same = file && *file == text;
    std::printf("%s %s what this fit gives\n", setup->population.file.c_str(),
                same ? "is" : "is NOT");
    return same ? kDone : kFailed;
  }
  const std::string path = command.out.empty() ? setup->population.file : command.out;
  if (Status status = write_file(path, text); !status) return complain(status, kFailed);
  std::printf("written: %s\n", path.c_str());
  return kDone;
}

}  // namespace handrail
