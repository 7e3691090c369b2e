#include "server/lab/study/linear_study.h"

#include "server/base/fnv.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

constexpr int kAttemptsPerTrial = 3;

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t what, std::uint64_t which) {
  return Fnv().u64(seed).u64(what).u64(which).value();
}

struct PersonResult {
  std::vector<StudyTrial> trials;
  double simulated_time = 0.0;
  Status status = Status::ok();
};

// One operator, all trials.
PersonResult run_person(const StudyMachine& machine, const Population& population,
                        const StudyOptions& options, int index) {
  PersonResult out;
  const std::uint64_t own = seed_of(options.seed, 0, static_cast<std::uint64_t>(index));
  Random random(own);
  TrialOptions trial;
  trial.person = population.draw(random);
  trial.arm_seed = seed_of(own, 1, 0);
  trial.tools_act = options.tools_act;
  const bool tools_first = (Random(seed_of(own, 2, 0)).bits() & 1) != 0;

  const int per_mode = options.practice + options.trials;
  for (int turn = 0; turn < kStudyModes; ++turn) {
    trial.mode = (turn == 0) == tools_first ? StudyMode::kTools : StudyMode::kFree;
    if (trial.mode == StudyMode::kTools && !options.with_tools) continue;
    int succeeded = 0;
    const int most = kAttemptsPerTrial * options.trials;
    for (int i = 0; i < most && succeeded < options.trials; ++i) {
      trial.number = turn * per_mode + options.practice + i + 1;
      trial.seed =
          seed_of(own, 3 + static_cast<std::uint64_t>(trial.mode), static_cast<std::uint64_t>(i));
      trial.keep_trace = index < options.traced;
      Result<TrialResult> result = run_linear_trial(machine, trial);
      if (!result) {
        out.status = result.status();
        return out;
      }
      out.simulated_time += result->simulated_time;
      succeeded += result->end == TrialEnd::kDone;
      out.trials.push_back({index, trial.mode, trial.number, i + 1, std::move(*result)});
    }
  }
  return out;
}

}  // namespace

Result<StudyResult> run_linear_study(const StudyMachine& machine, const Population& population,
                                     const StudyOptions& options) {
  std::vector<PersonResult> people(static_cast<std::size_t>(options.operators));
  const bool complete = run_parallel(
      people.size(), options.threads,
      [&](std::size_t i) {
        people[i] = run_person(machine, population, options, static_cast<int>(i));
      },
      options.progress, options.cancelled);
  if (!complete) return Status::error("cancelled");
  StudyResult out;
  for (PersonResult& person : people) {
    if (!person.status) return person.status;
    out.simulated_time += person.simulated_time;
    for (StudyTrial& trial : person.trials) out.trials.push_back(std::move(trial));
  }
  return out;
}

}  // namespace handrail
