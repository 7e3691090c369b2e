#include "server/lab/study/pattern_search.h"

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
  Judge(const std::vector<double>& aims, const MediansOf& medians_of, const FitOptions& options)
      : aims_(aims), medians_of_(medians_of), options_(options) {}

  // Misfit of a candidate; infinity once the run has failed.
  double misfit(const Population& candidate, std::vector<double>& medians) {
    Result<std::vector<double>> result = medians_of_(candidate);
    if (!result) {
      status_ = result.status();
      return std::numeric_limits<double>::infinity();
    }
    medians = std::move(*result);
    double sum = 0.0;
    for (std::size_t i = 0; i < aims_.size(); ++i) {
      const double error = std::log(medians[i] / aims_[i]);
      sum += error * error;
    }
    ++evaluations_;
    const double misfit = std::sqrt(sum / static_cast<double>(aims_.size()));
    if (options_.progress) options_.progress(evaluations_, misfit);
    return misfit;
  }

  const Status& status() const { return status_; }
  int evaluations() const { return evaluations_; }
  bool may_go_on() const { return status_.is_ok() && evaluations_ < options_.evaluations; }

 private:
  const std::vector<double>& aims_;
  const MediansOf& medians_of_;
  const FitOptions& options_;
  Status status_ = Status::ok();
  int evaluations_ = 0;
};

}  // namespace

Result<FitResult> fit_population(const Population& population, const std::vector<double>& aims,
                                 const MediansOf& medians_of, const FitOptions& options) {
  FitResult best;
  best.population = population;
  std::vector<ParameterRange*> free;
  for (ParameterRange& parameter : best.population.parameters) {
    if (!parameter.fitted) continue;
    parameter.median = rounded(std::sqrt(parameter.low * parameter.high), parameter.unit);
    free.push_back(&parameter);
  }
  if (free.empty()) return Status::error(population.file + ": no parameter is marked as fitted");

  Judge judge(aims, medians_of, options);
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
        std::vector<double> medians;
        const double misfit = judge.misfit(best.population, medians);
        if (misfit < best.misfit) {
          best.misfit = misfit;
          best.medians = std::move(medians);
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
