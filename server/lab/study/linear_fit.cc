#include "server/lab/study/linear_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handrail {
namespace {

constexpr double kFirstStep = 0.4;  // of a logarithm
constexpr double kLastStep = 0.04;

// Three digits, in the file's unit.
double rounded(double si, double unit) {
  const double value = si / unit;
  const double scale = std::pow(10.0, 2.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale * unit;
}

// What the candidates are judged by.
class Judge {
 public:
  Judge(const StudyMachine& machine, const FitOptions& options)
      : machine_(machine), options_(options) {
    study_.operators = options.operators;
    study_.seed = options.seed;
    study_.threads = options.threads;
    study_.with_tools = false;
    study_.cancelled = options.cancelled;
  }

  // Misfit of a candidate; infinity once the run has failed or been cancelled.
  double misfit(const Population& candidate, std::array<double, kPublishedFigures>& medians) {
    const Result<StudyResult> result = run_linear_study(machine_, candidate, study_);
    if (!result) {
      status_ = result.status();
      return std::numeric_limits<double>::infinity();
    }
    double sum = 0.0;
    for (int i = 0; i < kPublishedFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      const auto k = static_cast<std::size_t>(i);
      medians[k] = median(pooled(values_of(*result, StudyMode::kFree, figure)));
      const double error =
          std::log(medians[k] * info_of(figure).per_si / info_of(figure).published[0]);
      sum += error * error;
    }
    ++evaluations_;
    const double misfit = std::sqrt(sum / kPublishedFigures);
    if (options_.progress) options_.progress(evaluations_, misfit);
    return misfit;
  }

  const Status& status() const { return status_; }
  int evaluations() const { return evaluations_; }
  bool may_go_on() const { return status_.is_ok() && evaluations_ < options_.evaluations; }

 private:
  const StudyMachine& machine_;
  const FitOptions& options_;
  StudyOptions study_;
  Status status_ = Status::ok();
  int evaluations_ = 0;
};

}  // namespace

Result<FitResult> fit_linear(const StudyMachine& machine, const Population& population,
                             const FitOptions& options) {
  FitResult best;
  best.population = population;
  std::vector<ParameterRange*> free;
  for (ParameterRange& parameter : best.population.parameters) {
    if (!parameter.fitted) continue;
    parameter.median = rounded(std::sqrt(parameter.low * parameter.high), parameter.unit);
    free.push_back(&parameter);
  }
  if (free.empty()) return Status::error(population.file + ": no parameter is marked as fitted");

  Judge judge(machine, options);
  best.misfit = judge.misfit(best.population, best.medians);
  for (double step = kFirstStep; step >= kLastStep && judge.may_go_on();) {
    bool better = false;
    for (ParameterRange* parameter : free) {
      const double from = parameter->median;
      for (const double factor : {std::exp(step), std::exp(-step)}) {
        if (!judge.may_go_on()) break;
        parameter->median =
            rounded(std::clamp(from * factor, parameter->low, parameter->high), parameter->unit);
        if (parameter->median == from) continue;
        std::array<double, kPublishedFigures> medians{};
        const double misfit = judge.misfit(best.population, medians);
        if (misfit < best.misfit) {
          best.misfit = misfit;
          best.medians = medians;
          better = true;
          break;
        }
        parameter->median = from;
      }
    }
    if (!better) step *= 0.5;
  }
  if (!judge.status()) return judge.status();
  best.evaluations = judge.evaluations();
  return best;
}

}  // namespace handrail
