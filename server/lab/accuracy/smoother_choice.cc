#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "devices/hand/hand_wander.h"
#include "devices/hand/min_jerk.h"
#include "server/base/units.h"
#include "server/haptic/smoother.h"
#include "server/lab/accuracy/choices.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;          // [s]
constexpr double kTremor = 0.05 * kMm;  // RMS of three axes (hand_model.h) [m]
constexpr int kListen = 20000;          // ticks of tremor
constexpr double kReach = 80.0 * kMm;
constexpr double kReachTime = 1.0;  // [s]

// A minimum-jerk reach and when it is at a share of its way.
double reach(double t) {
  const double s = std::clamp(t / kReachTime, 0.0, 1.0);
  return kReach * s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

double reach_time(double x) {
  double before = 0.0, after = kReachTime;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (before + after);
    (reach(middle) < x ? before : after) = middle;
  }
  return 0.5 * (before + after);
}

ErrorSum tremor_left(PositionSmoother& smoother, int length) {
  HandWander wander(1, kTremor, 0.0, 0.0);
  smoother.reset(Vec3::Zero(), length);
  ErrorSum sum;
  for (int i = 0; i < kListen; ++i) {
    wander.step(kTick);
    const Vec3 left = smoother.push(wander.position());
    if (i >= kMaxSmootherLength) sum.add(left.norm());
  }
  return sum;
}

// How long ago the hand was where the command is, over the middle of the reach [s].
std::vector<double> lags(PositionSmoother& smoother, int length) {
  smoother.reset(Vec3::Zero(), length);
  std::vector<double> out;
  for (int i = 0; i * kTick < kReachTime + length * kTick; ++i) {
    const double t = i * kTick;
    const double x = smoother.push(Vec3(reach(t), 0.0, 0.0)).x();
    if (x > 0.01 * kReach && x < 0.99 * kReach)
      out.push_back(std::round((t - reach_time(x)) * 1e9) * 1e-9);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string setting(int length) {
  const char* form = length == 200 ? " (published)" : length == 105 ? " (low lag)" : "";
  return fmt::format("{} sample{}{}", length, length == 1 ? "" : "s", form);
}

}  // namespace

AccuracyRows smoother_rows() {
  const auto smoother = std::make_unique<PositionSmoother>();
  AccuracyRows rows;
  for (const int length : {1, 20, 35, 50, 70, 105, 150, 200, 300, 500, 1000}) {
    AccuracyRow row;
    row.choice = "smoother";
    row.method = "mean";
    row.setting = setting(length);
    row.error = tremor_left(*smoother, length).in("um", 1e6);
    const std::vector<double> lag = lags(*smoother, length);
    const auto last = static_cast<double>(lag.size() - 1);
    row.cost = {"ms", lag[lag.size() / 2] * 1e3, lag[static_cast<std::size_t>(0.999 * last)] * 1e3};
    row.memory_bytes = sizeof(PositionSmoother);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace handrail
