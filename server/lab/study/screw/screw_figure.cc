#include "server/lab/study/screw/screw_figure.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr ScrewFigureInfo kScrewInfo[kScrewFigures] = {
    {"completion_time_s", "completion time", "s", 1.0, {42.1, 33.3, 36.6, 28.7}},
    {"path_mm", "path of the tip", "mm", 1.0 / kMm, {271.0, 153.4, 257.0, 166.5}},
    {"mean_contact_force_n", "mean contact force", "N", 1.0, {50.2, 48.6, 26.7, 26.0}},
    {"max_contact_force_n", "largest contact force", "N", 1.0, {}},
    {"impulse_n_s", "impulse of the force", "N s", 1.0, {}},
    {"contact_time_s", "time in contact", "s", 1.0, {}},
};

}  // namespace

const ScrewFigureInfo& info_of(ScrewFigure figure) noexcept {
  return kScrewInfo[static_cast<int>(figure)];
}

double& value_in(ScrewResult& result, ScrewFigure figure) noexcept {
  switch (figure) {
    case ScrewFigure::kTime: break;
    case ScrewFigure::kPath: return result.measured.path;
    case ScrewFigure::kMeanForce: return result.measured.mean_force;
    case ScrewFigure::kMaxForce: return result.measured.max_force;
    case ScrewFigure::kImpulse: return result.measured.impulse;
    case ScrewFigure::kContactTime: return result.measured.contact_time;
  }
  return result.completion_time;
}

double measured_of(const ScrewResult& result, ScrewFigure figure) noexcept {
  return value_in(const_cast<ScrewResult&>(result), figure);  // NOLINT: reads it
}

double value_of(const ScrewResult& result, ScrewFigure figure) noexcept {
  const bool force = figure == ScrewFigure::kMeanForce || figure == ScrewFigure::kMaxForce;
  const bool counts = force ? result.measured.contact_time > 0.0 : result.end == ScrewEnd::kDone;
  return counts ? measured_of(result, figure) : std::numeric_limits<double>::infinity();
}

ByPerson values_of(const ScrewStudy& study, ScrewMode mode, ScrewFigure figure) {
  return study.values(mode, [&](const ScrewResult& result) { return value_of(result, figure); });
}

double worst_force(const ScrewStudy& study, ScrewMode mode) noexcept {
  double out = 0.0;
  for (const ScrewStudyTrial& trial : study.trials) {
    if (trial.mode == mode) out = std::max(out, trial.result.measured.max_force);
  }
  return out;
}

Paired comparison_of(const ScrewStudy& study, ScrewPairing pairing, ScrewFigure figure,
                     std::uint64_t seed) {
  const ScrewPair pair = pair_of(pairing);
  Random random(seed + 2);
  return compare_paired(values_of(study, pair.with, figure), values_of(study, pair.without, figure),
                        random);
}

double implied_ratio(ScrewPairing pairing, ScrewFigure figure) noexcept {
  const ScrewPair pair = pair_of(pairing);
  const double* implied = info_of(figure).implied;
  const double without = implied[static_cast<int>(pair.without)];
  return without > 0.0 ? implied[static_cast<int>(pair.with)] / without : 0.0;
}

FailureComparison failures_of(const ScrewStudy& study, ScrewPairing pairing) {
  const ScrewPair pair = pair_of(pairing);
  const auto failed = [](const ScrewResult& result) {
    return result.end == ScrewEnd::kDone ? 0.0 : 1.0;
  };
  const ByPerson without = study.values(pair.without, failed);
  const ByPerson with = study.values(pair.with, failed);
  std::vector<bool> no_more;
  for (std::size_t k = 0; k < without.size(); ++k) {
    const auto number = [](const std::vector<double>& of) {
      return std::accumulate(of.begin(), of.end(), 0.0);
    };
    no_more.push_back(number(with[k]) <= number(without[k]));
  }
  return {study.failures(pair.without), study.failures(pair.with), share_of(no_more)};
}

}  // namespace handrail
