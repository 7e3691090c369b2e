// What every study does with its simulated operators, whatever the task: who meets which modes,
// when, and how often.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "server/base/fnv.h"
#include "server/base/random.h"
#include "server/base/status.h"
#include "server/lab/study/parallel.h"
#include "server/lab/study/population.h"
#include "server/lab/study/statistics.h"

namespace handrail {

struct StudyPlan {
  int operators = 7;
  int trials = 2;    // successful ones wanted of each operator in each mode
  int practice = 1;  // trials in each mode before: they count as practice and are not run
  std::uint64_t seed = 1;
  int threads = 0;             // 0: one a core
  std::vector<int> only = {};  // modes to run, the others' trials count all the same; empty: all
  int traced = 0;              // operators, from the first, of whose trials the traces are kept
  std::function<void(std::size_t)> progress = {};  // operators done, from one thread at a time
  const std::atomic<bool>* cancelled = nullptr;
};

// So many trials are made for one success at most.
inline constexpr int kAttemptsPerTrial = 3;

template <typename Mode, typename Outcome>
struct StudyTrial {
  int person = 0;  // from 0
  Mode mode = {};
  // Among all this operator makes, practice included, from 1. A later mode's start where they would
  // without failures in the earlier ones.
  int number = 1;
  int attempt = 1;  // among the counted ones in this mode, from 1
  Outcome result;
};

template <typename Mode_, typename Outcome_>
struct StudyResult {
  using Mode = Mode_;
  using Outcome = Outcome_;
  using Trial = StudyTrial<Mode, Outcome>;
  using End = decltype(Outcome::end);

  std::vector<Trial> trials;    // counted ones: by operator, in the order made
  double simulated_time = 0.0;  // of everything run [s]

  int count(Mode mode) const {
    return count_if([&](const Trial& trial) { return trial.mode == mode; });
  }
  int count(Mode mode, End end) const {
    return count_if(
        [&](const Trial& trial) { return trial.mode == mode && trial.result.end == end; });
  }
  int failures(Mode mode) const { return count(mode) - count(mode, End::kDone); }

  // value_of(outcome) of all trials of a mode by operator; in every mode entry k is the same
  // person.
  template <typename ValueOf>
  ByPerson values(Mode mode, const ValueOf& value_of) const {
    ByPerson out;
    int person = -1;
    for (const Trial& trial : trials) {
      if (trial.person != person) out.emplace_back();
      person = trial.person;
      if (trial.mode == mode) out.back().push_back(value_of(trial.result));
    }
    return out;
  }

 private:
  template <typename Which>
  int count_if(const Which& which) const {
    return static_cast<int>(std::count_if(trials.begin(), trials.end(), which));
  }
};

// How a study was made, as its reports say.
struct StudyHeader {
  std::string scene;
  std::string population;
  std::uint32_t seed = 1;
  int operators = 0;
  int trials = 0;         // successful ones wanted of each operator in each mode
  bool simulated = true;  // the operators are; else people
};

// A study made again with something varied.
template <typename Study>
struct StudyVariation {
  std::string setting;  // as given, such as "rig.servo_spread=0.1"
  Study result;
};

inline std::uint64_t seed_of(std::uint64_t seed, std::uint64_t what, std::uint64_t which) {
  return Fnv().u64(seed).u64(what).u64(which).value();
}

// The numbers below `count` in random order (Fisher and Yates).
inline std::vector<int> shuffled(int count, Random& random) {
  std::vector<int> out(static_cast<std::size_t>(count));
  std::iota(out.begin(), out.end(), 0);
  for (std::size_t i = 0; i + 1 < out.size(); ++i) {
    std::swap(out[i], out[i + random.bits() % (out.size() - i)]);
  }
  return out;
}

// One operator, all trials. The first error ends it.
template <typename Study, typename Trial, typename RunTrial>
Result<Study> run_person(const StudyPlan& plan, int modes, const Population& population,
                         Trial trial, const RunTrial& run_trial, int index) {
  Study out;
  const std::uint64_t own = seed_of(plan.seed, 0, static_cast<std::uint64_t>(index));
  Random random(own);
  trial.person = population.draw(random);
  trial.arm_seed = seed_of(own, 1, 0);
  trial.keep_trace = index < plan.traced;
  Random ordering(seed_of(own, 2, 0));
  int before = 0;
  for (const int mode : shuffled(modes, ordering)) {
    const int first = before + plan.practice + 1;
    before += plan.practice + plan.trials;
    const auto& only = plan.only;
    if (!only.empty() && std::find(only.begin(), only.end(), mode) == only.end()) continue;
    trial.mode = static_cast<typename Study::Mode>(mode);
    int succeeded = 0;
    const int most = kAttemptsPerTrial * plan.trials;
    trial.subject = index + 1;
    for (int i = 0; i < most && succeeded < plan.trials; ++i) {
      if (plan.cancelled != nullptr && plan.cancelled->load()) return Status::error("cancelled");
      trial.number = first + i;
      trial.seed =
          seed_of(own, 3 + static_cast<std::uint64_t>(mode), static_cast<std::uint64_t>(i));
      Result<typename Study::Outcome> result = run_trial(trial);
      if (!result) return result.status();
      out.simulated_time += result->simulated_time;
      succeeded += result->end == Study::End::kDone;
      out.trials.push_back({index, trial.mode, trial.number, i + 1, std::move(*result)});
    }
  }
  return out;
}

// Each operator is drawn from the population, works with an arm of its own (joint lags drawn from
// the rig's spread) and meets all `modes` in random order, trials until `trials` have succeeded or
// three times as many were made. All that one trial leaves behind for the next is practice, which
// shortens the pause for decisions; so practice trials are counted, not run. Operator i of a seed
// is the same whatever the number of operators or threads. `trial` has what all trials have in
// common; run_trial(trial) gives a Result of an outcome, on several threads at once. The error is
// the trial's, or says that the study was cancelled.
template <typename Study, typename Trial, typename RunTrial>
Result<Study> run_study(const StudyPlan& plan, int modes, const Population& population,
                        const Trial& trial, const RunTrial& run_trial) {
  std::vector<Result<Study>> people(static_cast<std::size_t>(plan.operators),
                                    Status::error("not run"));
  const bool complete = run_parallel(
      people.size(), plan.threads,
      [&](std::size_t i) {
        people[i] =
            run_person<Study>(plan, modes, population, trial, run_trial, static_cast<int>(i));
      },
      plan.progress, plan.cancelled);
  if (!complete) return Status::error("cancelled");
  Study out;
  for (Result<Study>& person : people) {
    if (!person) return person.status();
    out.simulated_time += person->simulated_time;
    for (auto& done : person->trials) out.trials.push_back(std::move(done));
  }
  return out;
}

}  // namespace handrail
