#include "server/lab/hand/hand_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>

#include "devices/omni/omni_data.h"
#include "server/kinematics/arm_of.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

// A hand further off is no reading of a device [m].
constexpr double kFarthestHand = 5.0;
constexpr int kEngagePatience = 1000;  // ticks
constexpr int kSettle = 3000;          // ticks after the recording's end

ToolCall tool_call(const Scene& scene, const HandRunOptions& options) {
  ToolCall call;
  call.kind = options.tool;
  call.direction_S = scene.mapping.R_SM.col(0);
  call.one_way = options.one_way;
  if (options.tool == ToolKind::kPlane) {
    call.normal_S = scene.mapping.R_SM.col(2);
    if (!options.one_way) call.direction_S.setZero();
  }
  return call;
}

// Keeps the extremes of what goes to the controller.
class Judge {
 public:
  Judge(const ArmGeometry& arm, const PositionTool& tool, Nanos period)
      : arm_(arm), tool_(tool), dt_(to_seconds(period)) {}

  void see(const JointVector& q, HandRunResult& result) {
    if (!q.allFinite()) ++result.non_finite;
    const Vec3 p = forward(arm_, q).p;
    result.max_off_tool = std::max(result.max_off_tool, tool_.distance(p));
    const double travel = tool_.travel(p);
    if (seen_) {
      if (tool_.definition().one_way && travel < last_travel_ - kBackwardStep) {
        ++result.backward_steps;
      }
      const double ratio =
          ((q - last_q_).cwiseAbs().array() / (rv2a_limits().max_speed.array() * dt_)).maxCoeff();
      result.max_joint_speed_ratio = std::max(result.max_joint_speed_ratio, ratio);
    }
    seen_ = true;
    last_q_ = q;
    last_travel_ = travel;
  }

 private:
  ArmGeometry arm_;
  PositionTool tool_;
  double dt_;
  bool seen_ = false;
  JointVector last_q_ = JointVector::Zero();
  double last_travel_ = 0.0;
};

HandReading reading_at(const RecordedMotion& motion, double t) {
  HandReading hand;
  const VectorMotion state = motion.motion_at(t);
  hand.X_MH.p = state.p;
  hand.v_MH = state.v;
  hand.valid = true;
  return hand;
}

}  // namespace

Result<HandRunResult> run_hand(const Scene& scene, const RecordedMotion& motion,
                               const HandRunOptions& options) {
  if (motion.half_extent().maxCoeff() > kFarthestHand) {
    return Status::error(
        fmt::format("the recording reaches {:.0f} mm from its centre; expected at most {:.0f} mm",
                    motion.half_extent().maxCoeff() / kMm, kFarthestHand / kMm));
  }
  if (scene.walls) {
    return Status::error("scene " + scene.name +
                         " has walls and no arm, which a hand on a tool is led past; expected a "
                         "scene without walls, or: handrail-lab gearshift --hand FILE");
  }
  auto cell_options = std::make_unique<CellOptions>();
  cell_options->haptic = haptic_settings(scene, omni_capabilities(false));
  cell_options->follow = follow_settings(scene, cell_options->rig.controller.period, true, 1000.0);
  cell_options->rig.controller.arm.seed = options.seed;
  cell_options->rig.controller.arm.geometry = arm_of(scene);
  cell_options->rig.sensor.seed = options.seed + 1;
  run_only_listed(scene, cell_options->rig);
  auto cell = std::make_unique<Cell>(*cell_options);

  const HandReading start = reading_at(motion, 0.0);
  HapticOrder engage;
  engage.kind = OrderKind::kEngage;
  int waited = 0;
  while (cell->master_state().lead.session != SessionState::kEngaged) {
    if (++waited > kEngagePatience) {
      return Status::error(std::string("the cell did not engage: ") +
                           describe(cell->master().reason));
    }
    cell->tick(start, engage);
  }

  HapticOrder call;
  call.kind = OrderKind::kTool;
  call.tool = tool_call(scene, options);
  cell->tick(start, call);
  if (cell->master().order_result != Reason::kNone) {
    return Status::error(std::string("the tool was refused: ") +
                         describe(cell->master().order_result));
  }

  HandRunResult result;
  result.samples = motion.rows();
  result.gaps = motion.gaps();
  Judge judge(cell_options->follow.motion->arm, cell->master_state().command.guide.position(),
              cell_options->rig.controller.period);
  const auto ticks = static_cast<long>(motion.duration() * 1e3) + 1 + kSettle;
  for (long i = 0; i <= ticks; ++i) {
    cell->tick(reading_at(motion, static_cast<double>(i) * 1e-3));
    for (const JointVector& q : cell->sent()) judge.see(q, result);
    const HapticOutput& out = cell->master();
    result.max_force = std::max(result.max_force, out.f_H_M.force.norm());
    if (!is_finite(out.f_H_M) || !is_finite(out.link.X_SU)) ++result.non_finite;
  }
  return result;
}

}  // namespace handrail
