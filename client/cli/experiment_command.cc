#include "client/cli/experiment_command.h"

#include <charconv>

#include "client/cli/interrupt.h"
#include "client/experiment/experiment_run.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr int kMostTrials = 20;

// A whole number from 1 on; 0: it is none.
int count_in(const std::string& text, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && value >= 1 && value <= most ? value : 0;
}

}  // namespace

ExitCode run_experiment_command(const Options& options, const Console& console) {
  ExperimentWords words;
  words.experiment = *options.word;
  if (words.experiment != "linear-movement") {
    return complain(console, "experiment: there is no '" + shown(words.experiment) +
                                 "', expected linear-movement");
  }
  if (options.folder) words.folder = *options.folder;
  words.resume = options.resume;
  words.simulated = options.simulated;
  words.json = options.json;
  if (options.trials) words.rules.trials = count_in(*options.trials, kMostTrials);
  if (words.rules.trials == 0) {
    return complain(console,
                    "experiment: --trials '" + shown(*options.trials) + "', expected 1 to 20");
  }
  const ExperimentPlace place{options.master, options.as, console.out, console.err, interrupted};
  if (options.report) return report_experiment(words, options.figures.value_or(""), place);
  if (options.figures) return complain(console, "experiment: --figures goes with --report");
  if (!options.subject) {
    return complain(console, "experiment: expected --subject ID, or --report");
  }
  words.subject = *options.subject;
  catch_interrupts();
  return run_experiment(words, place);
}

}  // namespace handrail
