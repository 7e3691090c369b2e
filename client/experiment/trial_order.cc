#include "client/experiment/trial_order.h"

#include "server/base/fnv.h"
#include "server/base/random.h"
#include "server/lab/study/study_run.h"

namespace handrail {
namespace {

// What somebody has made in one mode.
struct InMode {
  int practised = 0;  // successes
  int counted = 0;    // trials that count
  int succeeded = 0;  // of those
};

InMode count(const std::vector<TrialMade>& made, int mode) {
  InMode out;
  for (const TrialMade& trial : made) {
    if (trial.mode != mode || trial.interrupted) continue;
    if (trial.practice) {
      out.practised += trial.done;
    } else {
      ++out.counted;
      out.succeeded += trial.done;
    }
  }
  return out;
}

}  // namespace

std::uint64_t subject_seed(const std::string& subject, const char* what) {
  return Fnv().text(what).text(subject).value();
}

std::vector<int> order_of_modes(const std::string& subject, int modes) {
  Random random(subject_seed(subject, "order of modes"));
  return shuffled(modes, random);
}

std::optional<TrialNext> next_trial(const ExperimentRules& rules, const std::vector<int>& order,
                                    const std::vector<TrialMade>& made) {
  TrialNext next;
  for (const TrialMade& trial : made) next.number += !trial.interrupted;
  for (const int mode : order) {
    const InMode in = count(made, mode);
    next.mode = mode;
    next.practice = in.practised < rules.practice;
    next.attempt = next.practice ? 0 : in.counted + 1;
    if (next.practice ||
        (in.succeeded < rules.trials && in.counted < kAttemptsPerTrial * rules.trials)) {
      return next;
    }
  }
  return std::nullopt;
}

}  // namespace handrail
