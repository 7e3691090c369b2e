// A simulated operator at the whole cell: what the studies' trials have in common.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/hand/operator_model.h"
#include "devices/omni/sim_omni.h"
#include "server/base/status.h"
#include "server/lab/cell/cell.h"
#include "server/model/scene.h"

namespace handrail {

// What operators are set before, the same in all modes.
struct StudyMachine {
  Scene scene;  // with what the study asks for
  RigOptions rig;
  Nanos transit = 0;          // one-way time of the link
  Nanos tick = kMillisecond;  // of the haptic loop
};

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
};

}  // namespace handrail
