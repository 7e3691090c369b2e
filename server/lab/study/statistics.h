// What can be said of a few numbers from a few people. Pure functions; randomness is an argument.
#pragma once

#include <cstddef>
#include <vector>

#include "server/base/random.h"

namespace handrail {

// A failed trial is +infinity: the worst rank. Any other value that is not finite counts as failed
// too. Quantiles are taken over all ranks, interpolated linearly (type 7 of Hyndman and Fan 1996)
// and infinite where a failure decides; min, max and mean are over the finite values. Without
// values everything is NaN; without finite ones min, max and mean are.
struct Summary {
  double min = 0.0, q1 = 0.0, median = 0.0, q3 = 0.0, max = 0.0, mean = 0.0;
  std::size_t count = 0;
  std::size_t failures = 0;
};
Summary summarise(const std::vector<double>& values);
// The quantile alone, q kept within 0 and 1.
double quantile(std::vector<double> values, double q);
double median(const std::vector<double>& values);

// Values by person: what one person does is not independent, so people are resampled, not trials.
// People without values are left out of everything below.
using ByPerson = std::vector<std::vector<double>>;
std::vector<double> pooled(const ByPerson& people);

struct Interval {
  double low = 0.0, high = 0.0;
};

inline constexpr int kResamples = 2000;

// 95 % percentile interval of the pooled median under resampling of people (Efron and Tibshirani
// 1993, 13). With a single person it is a point, which says nothing of other people; without
// values or resamples it is NaN. Deterministic for the state of `random`.
Interval bootstrap_median(const ByPerson& people, Random& random, int resamples = kResamples);

// Two modes of the same people, person by person. Values must not be negative.
struct Paired {
  std::size_t people = 0;  // compared: those with values in both modes
  double ratio = 0.0;      // pooled median of `with` over that of `without`; 1 when they tie, also
                           // in failure, infinity when only `with` fails and 0 when only `without`
  Interval ratio_95;
  double helped = 0.0;  // share of people whose own median is lower `with`; a tie counts half
  Interval helped_95;   // as in share_95()
};
// Entry k of both lists is the same person; entries beyond the shorter list are left out. The
// ratio's interval is as in bootstrap_median(). Without people all is NaN.
Paired compare_paired(const ByPerson& with, const ByPerson& without, Random& random,
                      int resamples = kResamples);

// Where the share of all people lies, in 95 % of studies, of whom something is true of `count` in
// `of` people: the exact interval of Clopper and Pearson (Biometrika 26, 1934). All of a few people
// are not everybody: 60 of 60 are 94 to 100 %. NaN without people. `count` 0..of, halves too.
Interval share_95(double count, std::size_t of);

// The share of people of whom something is true.
struct Share {
  double value = 0.0;
  Interval value_95;
};
Share share_of(const std::vector<bool>& people);

// Where the medians of cohorts of `size` people, at least one, drawn without replacement, lie: 2.5
// to 97.5 %. With no more people than that there is one cohort only, and the interval is a point;
// without values or draws it is NaN.
Interval cohort_spread(const ByPerson& people, std::size_t size, Random& random,
                       int draws = kResamples);

}  // namespace handrail
