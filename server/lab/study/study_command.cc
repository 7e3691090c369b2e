#include "server/lab/study/study_command.h"

#include <algorithm>

#include "server/base/output.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/lab/study/population_io.h"
#include "server/scene/text_io.h"

namespace handrail {
namespace {

// The variations a command asks for: what each sets beside nothing else.
Result<std::vector<std::vector<std::string>>> variations_of(const StudyCommand& command) {
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

}  // namespace

Result<std::vector<StudyRun>> study_runs(const StudyCommand& command, const Suits& suits) {
  auto variations = variations_of(command);
  if (!variations) return variations.status();
  variations->insert(variations->begin(), std::vector<std::string>());
  std::vector<StudyRun> out;
  for (const auto& settings : *variations) {
    auto setup = study_setup(command.scene, command.population, settings);
    if (!setup) return setup.status();
    if (Status s = suits(*setup); !s) return s;
    out.push_back({joined(settings, " "), std::move(*setup)});
  }
  return out;
}

int run_fit(const FitCommand& command, const FitJob& job, const std::atomic<bool>& cancelled) {
  const auto setup = study_setup(command.scene, command.population, {});
  if (!setup) return complain(setup.status(), kUsage);
  if (Status s = job.suits(*setup); !s) return complain(s, kUsage);
  FitOptions options;
  options.operators = command.operators;
  options.seed = command.seed;
  options.threads = command.threads;
  options.evaluations = command.evaluations;
  options.cancelled = &cancelled;
  Progress progress;
  const auto of_bound = [&](int tried) {
    return "fit: " + std::to_string(tried) + " of at most " + std::to_string(command.evaluations) +
           " candidates";
  };
  progress.show(of_bound(0));
  options.progress = [&](int evaluation, double misfit) {
    char text[32];
    std::snprintf(text, sizeof text, ", misfit %.3f", misfit);
    progress.show(of_bound(evaluation) + text);
  };
  const auto fit = job.fit(*setup, options);
  progress.clear();
  if (!fit) return complain(fit.status(), cancelled ? kCancelled : kFailed);

  std::printf("%d candidates, %d operators, seed %u; mode %s alone\n", fit->evaluations,
              command.operators, command.seed, job.mode);
  for (std::size_t i = 0; i < job.aims.size(); ++i) {
    const FitAim& aim = job.aims[i];
    std::printf("  %-28s %8.3g %s, %s %.4g\n", aim.title, fit->medians[i], aim.unit, job.known,
                aim.value);
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
