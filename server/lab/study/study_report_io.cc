#include "server/lab/study/study_report_io.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "proto/study.pb.h"

namespace handrail {
namespace {

// Three digits, without an exponent.
std::string digits(double value) {
  return std::abs(value) < 999.5 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string digits(const Interval& interval) {
  return digits(interval.low) + " to " + digits(interval.high);
}

constexpr std::size_t kCohort = 7;  // people in the dissertation's studies

}  // namespace

MeasureStats stats_of(ByPerson values, double per_si, std::uint64_t seed) {
  for (auto& person : values) {
    for (double& value : person) value *= per_si;
  }
  Random bootstrap(seed), cohorts(seed + 1);
  return {summarise(pooled(values)), bootstrap_median(values, bootstrap),
          cohort_spread(values, kCohort, cohorts)};
}

void fill(const Interval& interval, pb::Interval& out) {
  out.set_low(interval.low);
  out.set_high(interval.high);
}

void fill(const MeasureStats& stats, double published, pb::Measure& out) {
  out.set_min(stats.summary.min);
  out.set_q1(stats.summary.q1);
  out.set_median(stats.summary.median);
  out.set_q3(stats.summary.q3);
  out.set_max(stats.summary.max);
  out.set_mean(stats.summary.mean);
  out.set_failures(static_cast<std::uint32_t>(stats.summary.failures));
  fill(stats.median_95, *out.mutable_median_95());
  fill(stats.cohort_95, *out.mutable_cohort_95());
  if (published > 0.0) out.set_published(published);
}

void fill(const Paired& paired, pb::Comparison& out) {
  out.set_ratio(paired.ratio);
  fill(paired.ratio_95, *out.mutable_ratio_95());
  out.set_helped(paired.helped);
  fill(paired.helped_95, *out.mutable_helped_95());
}

std::string measures_heading(const std::string& published) {
  return fmt::format("{:40}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}  {:>15}  {:>15}{:>11}\n", "", "min",
                     "q1", "median", "q3", "max", "mean", "failed", "median, 95 %", "cohorts of 7",
                     published);
}

std::string measure_row(const std::string& label, const char* mode, const MeasureStats& stats,
                        double published) {
  const Summary& s = stats.summary;
  return fmt::format("{:34}{:<6}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}  {:>15}  {:>15}{:>11}\n", label,
                     mode, digits(s.min), digits(s.q1), digits(s.median), digits(s.q3),
                     digits(s.max), digits(s.mean), s.failures, digits(stats.median_95),
                     digits(stats.cohort_95),
                     published > 0.0 ? fmt::format("{:.4g}", published) : "");
}

std::string comparison_heading(const std::string& title, const std::string& ratio,
                               const std::string& expected) {
  return fmt::format("\n{:38}{:>12}  {:>16}{:>18}  {:>14}{}\n", title, ratio, "95 %",
                     "operators helped", "95 %",
                     expected.empty() ? "" : fmt::format("{:>11}", expected));
}

std::string comparison_row(const std::string& title, const Paired& p, double expected) {
  return fmt::format("{:38}{:>12.3f}  {:>16}{:>16.0f} %  {:>14}{}\n", title, p.ratio,
                     text_of(p.ratio_95, 1.0, "{:.3f} to {:.3f}"), 100.0 * p.helped,
                     text_of(p.helped_95, 100.0, "{:.0f} to {:.0f} %"),
                     expected > 0.0 ? fmt::format("{:>11.3f}", expected) : "");
}

std::string text_of(const Interval& interval, double scale, const char* format) {
  return fmt::format(fmt::runtime(format), scale * interval.low, scale * interval.high);
}

}  // namespace handrail
