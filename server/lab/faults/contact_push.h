// A hand that pushes the arm into a surface, for the rows of the fault matrix in contact.
#pragma once

#include <functional>

#include "server/lab/faults/fault_run.h"

namespace handrail {

// A run whose hand pushes into the surface, and whose force is watched. From go_down() on the hand
// goes down at `speed` to 10 mm below the surface and stays, and goes to and fro along it if
// `slide`.
class Push {
 public:
  static constexpr Nanos kCycle = 7'100 * kMicrosecond;
  static constexpr double kThreshold = 50.0;  // f_th [N]
  static constexpr double kPromise = 200.0;   // that no true force passes [N]

  // The seed also draws speed and way of the slide.
  Push(const RowRun& row, bool slide, FaultOptions options = {});
  Push(const Push&) = delete;

  // Engages, and begins to push.
  bool begin();
  // Engages, and goes to and fro over the surface for `span`.
  bool roam(Nanos span);
  void go_down();
  void retreat() { back_ = run.now(); }
  // From here on the sensor repeats its next reading.
  void freeze_sensor();

  // Lets `span` pass with an operator who engages again if `driven`.
  void pass(Nanos span, bool driven = false);
  // The same until the true force passes `force`, at most ten seconds: when it did, or kForever.
  Nanos pass_until(double force);

  // Everything found, with the largest true force, at most `bound` [N]. A sensor that lies about
  // the force's size (`lies`) has no say in which steps go in.
  FaultOutcome outcome(bool lies = false, double bound = kPromise);
  // Peak to peak of the true force over the next second [N].
  double swing();

  FaultRun run;
  std::function<void(Nanos, Wrench&, bool&)> falsify;
  double peak = 0.0;   // [N]
  double speed = 0.0;  // of the hand, down [m/s]

 private:
  double height() { return run.auditor().tip().dot(fault_normal()); }
  void lead(Nanos at, HandReading& hand) const;
  void watch(double felt, double before, double way);

  double rate_ = 0.0;
  Vec3 along_;
  Nanos roam_from_ = kForever, from_ = kForever, back_ = kForever;
  double measured_ = 0.0;  // newest reading [N]
  double lowest_ = -1.0;   // [m]
  std::uint64_t inward_ = 0;
};

}  // namespace handrail
