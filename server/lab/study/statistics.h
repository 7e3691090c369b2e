// What can be said of a few numbers from a few people.
#pragma once

#include <cstddef>
#include <vector>

#include "server/base/random.h"

namespace handrail {

// A failed trial is +infinity: the worst rank. Quantiles are taken over all ranks, interpolated
// linearly (type 7 of Hyndman and Fan 1996) and infinite where a failure decides; min, max and mean
// are over the finite values. Without values everything is NaN; without finite ones min, max and
// mean are.
struct Summary {
  double min = 0.0, q1 = 0.0, median = 0.0, q3 = 0.0, max = 0.0, mean = 0.0;
  std::size_t count = 0;
  std::size_t failures = 0;
};
Summary summarise(const std::vector<double>& values);
// The quantile alone, 0 <= q <= 1.
double quantile(std::vector<double> values, double q);
double median(const std::vector<double>& values);

// Values by person: what one person does is not independent, so people are resampled, not trials.
using ByPerson = std::vector<std::vector<double>>;
std::vector<double> pooled(const ByPerson& people);

struct Interval {
  double low = 0.0, high = 0.0;
};

inline constexpr int kResamples = 2000;

// 95 % percentile interval of the pooled median under resampling of people (Efron and Tibshirani
// 1993, 13). With a single person it is a point. Deterministic for the state of `random`.
Interval bootstrap_median(const ByPerson& people, Random& random, int resamples = kResamples);

// Two modes of the same people, person by person.
struct Paired {
  double ratio = 0.0;  // pooled median of `with` over that of `without`
  Interval ratio_95;
  double helped = 0.0;  // share of people whose own median is lower `with`; a tie counts half
  Interval helped_95;
};
Paired compare_paired(const ByPerson& with, const ByPerson& without, Random& random,
                      int resamples = kResamples);

// Where the medians of cohorts of `size` people, drawn without replacement, lie: 2.5 to 97.5 %.
// With no more people than that there is one cohort only, and the interval is a point.
Interval cohort_spread(const ByPerson& people, std::size_t size, Random& random,
                       int draws = kResamples);

}  // namespace handrail
