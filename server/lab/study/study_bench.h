// A simulated operator at the whole cell: what the studies' trials have in common.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "devices/hand/operator_model.h"
#include "devices/omni/sim_omni.h"
#include "server/base/status.h"
#include "server/lab/cell/cell.h"
#include "server/lab/study/trial_recording.h"
#include "server/model/scene.h"

namespace handrail {

// What operators are set before, the same in all modes.
struct StudyMachine {
  Scene scene;  // with what the study asks for
  RigOptions rig;
  Nanos transit = 0;          // one-way time of the link
  Nanos tick = kMillisecond;  // of the haptic loop
  bool torque = false;        // the device turns the stylus too
  StudyRecording recording;   // of every trial
};

// A larger component of the force is a fault [N].
inline constexpr double kStudySensorRange = 1000.0;

// The cell of a machine whose arm stands at `X_ST`; the error says that it cannot, and names `what`
// the scene wants there.
Result<std::unique_ptr<CellOptions>> study_cell(const StudyMachine& machine, const Pose& X_ST,
                                                const char* what, std::uint64_t arm_seed,
                                                std::uint64_t sensor_seed);

// The operator at the cell, tick by tick. Large: keep it on the heap.
class StudyBench {
 public:
  StudyBench(const StudyMachine& machine, const CellOptions& cell, const OperatorParameters& person,
             std::uint64_t seed);

  // Engages with the clutch closed and rests a little; false if the cell does not engage.
  bool engage();
  void tick(const HapticOrder& order);
  // Records from the first tick on, where the machine says so; `trial` as TrialRecording has it.
  // The error says that it is there already.
  Status record(const StudyMachine& machine, const std::string& trial);
  // The error names the file. Nothing without a recording.
  Status finish_recording(const std::string& end);
  void clutch(bool closed) { clutch_ = closed; }
  OperatorModel& mind() { return mind_; }
  void leave_off() { mind_.leave_off(*omni_.hand()); }
  const Cell& cell() const { return cell_; }
  const Pose& tip() const { return tip_; }  // true, X_ST
  double now() const { return now_; }       // [s]
  bool driving() const {
    const SessionState state = cell_.master_state().lead.session;
    return state == SessionState::kEngaged || state == SessionState::kClutched;
  }

 private:
  Pose in_sight() const;

  double dt_;
  double now_ = 0.0;
  bool clutch_ = true;
  Cell cell_;
  SimOmni omni_;
  OperatorModel mind_;
  Pose tip_;
  std::unique_ptr<TrialRecording> recording_;  // null: none
};

// What every trial is told.
template <typename Mode>
struct TrialPlan {
  Mode mode = {};
  OperatorParameters person;
  int subject = 1;             // whose trial it is, from 1
  int number = 1;              // of this trial among all the operator makes, from 1
  std::uint64_t seed = 1;      // of everything that differs from trial to trial
  std::uint64_t arm_seed = 1;  // of the arm's joint lags
  bool keep_trace = false;
};

// What a recording calls a trial of the experiment.
template <typename Mode>
std::string name_of(const std::string& experiment, const TrialPlan<Mode>& plan) {
  return experiment + " " + name_of(plan.mode) + " sim" + std::to_string(plan.subject) + " " +
         std::to_string(plan.number);
}

// What the operator of a trial takes for a decision; practice shortens it [s].
template <typename Mode>
double pause_of(const TrialPlan<Mode>& plan) {
  return plan.person.pause * std::pow(plan.number, -plan.person.practice);
}

// The procedure's steps give false once the trial has ended. `Outcome`: with its `end`, which is
// kDone, kSession, kTimeOut or of the trial's own, and `simulated_time`.
template <typename Outcome>
class TimedTrial {
 public:
  using End = decltype(Outcome::end);

  template <typename Mode>
  TimedTrial(const TrialPlan<Mode>& plan, StudyBench& bench, double limit)
      : bench_(bench), limit_(limit), pause_(pause_of(plan)) {}
  virtual ~TimedTrial() = default;

 protected:
  bool fail(End end) {
    result_.end = end;
    return false;
  }
  bool engage() { return bench_.engage() || fail(End::kSession); }

  // One tick with everything that is watched all the time.
  bool step(const HapticOrder& order = {}) {
    bench_.tick(order);
    return bench_.driving() ? watch(order) : fail(End::kSession);
  }
  bool wait(double seconds) {
    const double until = bench_.now() + seconds;
    while (bench_.now() < until) {
      if (!step()) return false;
    }
    return true;
  }
  // To decide what to do next; practice shortens it.
  bool decide() { return wait(pause_); }

  bool start_clock() {
    if (timed_) return true;
    timed_ = true;
    started_ = bench_.now();
    begin();
    return true;
  }
  bool timed() const { return timed_; }
  double elapsed() const { return bench_.now() - started_; }  // [s]
  bool in_time() { return elapsed() <= limit_ || fail(End::kTimeOut); }

  // After the last step.
  Outcome finish() {
    result_.simulated_time = bench_.now();
    return std::move(result_);
  }

  StudyBench& bench_;
  Outcome result_;

 private:
  // What the tick with `order` has brought.
  virtual bool watch(const HapticOrder& order) = 0;
  // Called when the clock starts.
  virtual void begin() = 0;

  double limit_;  // [s]
  double pause_;  // [s]
  double started_ = 0.0;
  bool timed_ = false;
};

}  // namespace handrail
