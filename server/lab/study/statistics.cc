#include "server/lab/study/statistics.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "server/lab/figure/quantile.h"

namespace handrail {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kWorstRank = std::numeric_limits<double>::infinity();

// Puts everything that is not finite into the worst rank.
void rank_failures_last(std::vector<double>& values) {
  for (double& v : values) v = std::isfinite(v) ? v : kWorstRank;
}

// The median of ranked values; changes their order.
double median_of(std::vector<double>& values) {
  if (values.empty()) return kNaN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return between(*std::max_element(values.begin(), middle), *middle, 0.5);
}

Interval middle_95(std::vector<double> values) {
  if (values.empty()) return {kNaN, kNaN};
  std::sort(values.begin(), values.end());
  return {quantile_of_sorted(values, 0.025), quantile_of_sorted(values, 0.975)};
}

// Uniform below n, n >= 1.
std::size_t pick(std::size_t n, Random& random) {
  return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(n)), n - 1);
}

double ratio_of(double a, double b) { return a == b ? 1.0 : a / b; }

void append(std::vector<double>& to, const std::vector<double>& values) {
  to.insert(to.end(), values.begin(), values.end());
}

// Those with values, failures ranked last.
ByPerson with_values(ByPerson people) {
  std::erase_if(people, [](const auto& values) { return values.empty(); });
  for (auto& values : people) rank_failures_last(values);
  return people;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return kNaN;
  rank_failures_last(values);
  std::sort(values.begin(), values.end());
  return quantile_of_sorted(values, std::clamp(q, 0.0, 1.0));
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

Summary summarise(const std::vector<double>& values) {
  Summary out;
  out.count = values.size();
  out.min = out.q1 = out.median = out.q3 = out.max = out.mean = kNaN;
  if (values.empty()) return out;
  std::vector<double> sorted = values;
  rank_failures_last(sorted);
  std::sort(sorted.begin(), sorted.end());
  const auto first_failure = std::lower_bound(sorted.begin(), sorted.end(), kWorstRank);
  out.failures = static_cast<std::size_t>(sorted.end() - first_failure);
  out.q1 = quantile_of_sorted(sorted, 0.25);
  out.median = quantile_of_sorted(sorted, 0.5);
  out.q3 = quantile_of_sorted(sorted, 0.75);
  const std::size_t finite = out.count - out.failures;
  if (finite == 0) return out;
  out.min = sorted.front();
  out.max = sorted[finite - 1];
  out.mean = std::accumulate(sorted.begin(), first_failure, 0.0) / static_cast<double>(finite);
  return out;
}

std::vector<double> pooled(const ByPerson& people) {
  std::vector<double> all;
  for (const auto& person : people) append(all, person);
  return all;
}

Interval bootstrap_median(const ByPerson& people, Random& random, int resamples) {
  const ByPerson persons = with_values(people);
  std::vector<double> medians, sample;
  for (int i = 0; i < resamples && !persons.empty(); ++i) {
    sample.clear();
    for (std::size_t k = 0; k < persons.size(); ++k) {
      append(sample, persons[pick(persons.size(), random)]);
    }
    medians.push_back(median_of(sample));
  }
  return middle_95(std::move(medians));
}

Paired compare_paired(const ByPerson& with, const ByPerson& without, Random& random,
                      int resamples) {
  ByPerson a_of, b_of;
  std::vector<double> helped;
  for (std::size_t k = 0; k < std::min(with.size(), without.size()); ++k) {
    if (with[k].empty() || without[k].empty()) continue;
    rank_failures_last(a_of.emplace_back(with[k]));
    rank_failures_last(b_of.emplace_back(without[k]));
    const double a = median(with[k]);
    const double b = median(without[k]);
    helped.push_back(a < b ? 1.0 : (a == b ? 0.5 : 0.0));
  }
  Paired out;
  out.people = helped.size();
  out.ratio = ratio_of(median(pooled(a_of)), median(pooled(b_of)));
  const double count = std::accumulate(helped.begin(), helped.end(), 0.0);
  out.helped = count / static_cast<double>(out.people);
  out.helped_95 = share_95(count, out.people);

  std::vector<double> ratios, a, b;
  for (int i = 0; i < resamples && out.people > 0; ++i) {
    a.clear();
    b.clear();
    for (std::size_t k = 0; k < out.people; ++k) {
      const std::size_t person = pick(out.people, random);
      append(a, a_of[person]);
      append(b, b_of[person]);
    }
    ratios.push_back(ratio_of(median_of(a), median_of(b)));
  }
  out.ratio_95 = middle_95(std::move(ratios));
  return out;
}

Interval share_95(double count, std::size_t of) {
  using Binomial = boost::math::binomial_distribution<double>;
  if (of == 0) return {kNaN, kNaN};
  const auto n = static_cast<double>(of);
  constexpr double kSide = 0.025;
  return {Binomial::find_lower_bound_on_p(n, count, kSide),
          Binomial::find_upper_bound_on_p(n, count, kSide)};
}

Share share_of(const std::vector<bool>& people) {
  const auto all = static_cast<double>(std::count(people.begin(), people.end(), true));
  return {all / static_cast<double>(people.size()), share_95(all, people.size())};
}

Interval cohort_spread(const ByPerson& people, std::size_t size, Random& random, int draws) {
  const ByPerson persons = with_values(people);
  std::vector<std::size_t> order(persons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t cohort = std::min(std::max<std::size_t>(size, 1), persons.size());
  std::vector<double> medians, sample;
  for (int i = 0; i < draws && cohort > 0; ++i) {
    sample.clear();
    for (std::size_t k = 0; k < cohort; ++k) {
      std::swap(order[k], order[k + pick(order.size() - k, random)]);
      append(sample, persons[order[k]]);
    }
    medians.push_back(median_of(sample));
  }
  return middle_95(std::move(medians));
}

}  // namespace handrail
