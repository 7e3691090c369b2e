#include "server/lab/scenes/contest.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace handrail {
namespace {

using Clock = std::chrono::steady_clock;

double ns_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::nano>(to - from).count();
}

template <typename T>
double quantile(std::vector<T> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank =
      static_cast<std::ptrdiff_t>(std::min(std::ceil(share * static_cast<double>(values.size())),
                                           static_cast<double>(values.size())) -
                                  1.0);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(rank)]);
}

// Median of two readings one after the other [ns].
double clock_cost() {
  std::vector<double> samples;
  for (int i = 0; i < 1000; ++i) {
    const auto from = Clock::now();
    samples.push_back(ns_between(from, Clock::now()));
  }
  return quantile(samples, 0.5);
}

}  // namespace

void Contest::add(std::function<void()> prepare, std::function<void()> batch, int calls) {
  Entrant entrant;
  entrant.prepare = std::move(prepare);
  entrant.batch = std::move(batch);
  entrant.calls = calls;
  entrants_.push_back(std::move(entrant));
}

void Contest::run(int turns, int batches, const std::atomic<bool>& cancelled) {
  const double clock = clock_cost();
  std::vector<float> samples(static_cast<std::size_t>(batches));
  for (int turn = 0; turn <= turns; ++turn) {
    for (std::size_t i = 0; i < entrants_.size(); ++i) {
      if (cancelled) return;
      // Who goes first brings what all use into the cache: nobody always does.
      Entrant& e = entrants_[(i + static_cast<std::size_t>(turn)) % entrants_.size()];
      e.prepare();
      e.batch();
      for (float& sample : samples) {
        const auto from = Clock::now();
        e.batch();
        const double spent = ns_between(from, Clock::now());
        sample = static_cast<float>(std::max(spent - clock, 0.0) / e.calls);
      }
      if (turn == 0) continue;
      e.samples.insert(e.samples.end(), samples.begin(), samples.end());
      e.turns.push_back(quantile(samples, 0.5));
    }
  }
}

Contest::Time Contest::time(std::size_t i) const {
  const std::vector<float>& samples = entrants_[i].samples;
  return {quantile(samples, 0.5), quantile(samples, 0.999)};
}

double Contest::longer(std::size_t i, std::size_t k) const {
  const std::vector<double>&a = entrants_[i].turns, &b = entrants_[k].turns;
  std::vector<double> differences;
  for (std::size_t turn = 0; turn < std::min(a.size(), b.size()); ++turn) {
    differences.push_back(a[turn] - b[turn]);
  }
  return quantile(differences, 0.5);
}

}  // namespace handrail
