#include "server/lab/study/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace handrail {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Of sorted values, at least one.
double quantile_of_sorted(const std::vector<double>& sorted, double q) {
  const double rank = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const double share = rank - static_cast<double>(below);
  if (share == 0.0) return sorted[below];
  if (!std::isfinite(sorted[below + 1])) return sorted[below + 1];
  return sorted[below] + share * (sorted[below + 1] - sorted[below]);
}

Interval middle_95(std::vector<double> values) {
  if (values.empty()) return {kNaN, kNaN};
  std::sort(values.begin(), values.end());
  return {quantile_of_sorted(values, 0.025), quantile_of_sorted(values, 0.975)};
}

std::size_t pick(std::size_t n, Random& random) {
  return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(n)), n - 1);
}

double ratio_of(double a, double b) { return std::isfinite(b) ? a / b : kNaN; }

// 1 lower, 0 higher, 0.5 equal.
double lower(const std::vector<double>& with, const std::vector<double>& without) {
  const double a = median(with);
  const double b = median(without);
  return a < b ? 1.0 : a == b ? 0.5 : 0.0;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  return quantile_of_sorted(values, q);
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

Summary summarise(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto first_failure =
      std::find_if(sorted.begin(), sorted.end(), [](double v) { return !std::isfinite(v); });
  Summary out;
  out.count = sorted.size();
  out.failures = static_cast<std::size_t>(sorted.end() - first_failure);
  out.q1 = quantile(sorted, 0.25);
  out.median = quantile(sorted, 0.5);
  out.q3 = quantile(sorted, 0.75);
  const std::size_t finite = out.count - out.failures;
  if (finite == 0) {
    out.min = out.max = out.mean = kNaN;
    return out;
  }
  out.min = sorted.front();
  out.max = sorted[finite - 1];
  out.mean = std::accumulate(sorted.begin(), first_failure, 0.0) / static_cast<double>(finite);
  return out;
}

std::vector<double> pooled(const ByPerson& people) {
  std::vector<double> all;
  for (const auto& person : people) all.insert(all.end(), person.begin(), person.end());
  return all;
}

Interval bootstrap_median(const ByPerson& people, Random& random, int resamples) {
  std::vector<double> medians;
  std::vector<double> sample;
  for (int i = 0; i < resamples && !people.empty(); ++i) {
    sample.clear();
    for (std::size_t k = 0; k < people.size(); ++k) {
      const auto& person = people[pick(people.size(), random)];
      sample.insert(sample.end(), person.begin(), person.end());
    }
    medians.push_back(median(sample));
  }
  return middle_95(std::move(medians));
}

Paired compare_paired(const ByPerson& with, const ByPerson& without, Random& random,
                      int resamples) {
  const std::size_t people = std::min(with.size(), without.size());
  Paired out;
  std::vector<double> helped(people);
  for (std::size_t k = 0; k < people; ++k) helped[k] = lower(with[k], without[k]);
  const auto n = static_cast<double>(people);
  out.ratio = ratio_of(median(pooled(with)), median(pooled(without)));
  out.helped = people > 0 ? std::accumulate(helped.begin(), helped.end(), 0.0) / n : kNaN;

  std::vector<double> ratios, shares, a, b;
  for (int i = 0; i < resamples && people > 0; ++i) {
    a.clear();
    b.clear();
    double sum = 0.0;
    for (std::size_t k = 0; k < people; ++k) {
      const std::size_t person = pick(people, random);
      a.insert(a.end(), with[person].begin(), with[person].end());
      b.insert(b.end(), without[person].begin(), without[person].end());
      sum += helped[person];
    }
    ratios.push_back(ratio_of(median(a), median(b)));
    shares.push_back(sum / n);
  }
  std::erase_if(ratios, [](double r) { return std::isnan(r); });
  out.ratio_95 = middle_95(std::move(ratios));
  out.helped_95 = middle_95(std::move(shares));
  return out;
}

Interval cohort_spread(const ByPerson& people, std::size_t size, Random& random, int draws) {
  std::vector<std::size_t> order(people.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t cohort = std::min(size, people.size());
  std::vector<double> medians;
  for (int i = 0; i < draws && cohort > 0; ++i) {
    std::vector<double> sample;
    for (std::size_t k = 0; k < cohort; ++k) {
      std::swap(order[k], order[k + pick(order.size() - k, random)]);
      const auto& person = people[order[k]];
      sample.insert(sample.end(), person.begin(), person.end());
    }
    medians.push_back(median(sample));
  }
  return middle_95(std::move(medians));
}

}  // namespace handrail
