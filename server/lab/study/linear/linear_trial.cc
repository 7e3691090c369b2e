#include "server/lab/study/linear/linear_trial.h"

#include <memory>

namespace handrail {
namespace {

constexpr std::size_t kOrders = 2;  // to call a phase's tools

HapticOrder line_order(const Vec3& from, const Vec3& to) {
  HapticOrder order;
  order.kind = OrderKind::kTool;
  order.tool.kind = ToolKind::kLine;
  order.tool.at_present = false;
  order.tool.p_SA = from;
  order.tool.direction_S = to - from;
  order.tool.one_way = true;
  order.tool.has_end = true;
  order.tool.p_SE = to;
  return order;
}

HapticOrder n_rotation_order() {
  HapticOrder order;
  order.kind = OrderKind::kTool;
  order.tool.kind = ToolKind::kNRotation;
  return order;
}

std::array<HapticOrder, kOrders> orders_of(const LinearTask& task, LinearPhase phase) {
  switch (phase) {
    case LinearPhase::kToB: return {line_order(task.p_SA, task.p_SB), n_rotation_order()};
    case LinearPhase::kTurn: {
      HapticOrder point;
      point.kind = OrderKind::kTool;
      point.tool.kind = ToolKind::kPoint;
      point.tool.at_present = false;
      point.tool.p_SA = task.p_SB;
      HapticOrder release;
      release.kind = OrderKind::kToolOff;
      release.drop_position = false;
      return {point, release};
    }
    case LinearPhase::kToC: return {line_order(task.p_SB, task.p_SC), n_rotation_order()};
  }
  return {};
}

// A trial on the bench.
class LinearTrialRun : TimedTrial<TrialResult> {
 public:
  LinearTrialRun(const LinearTask& task, const TrialOptions& options, StudyBench& bench)
      : TimedTrial(options, bench, kTrialLimit), task_(task), options_(options), measure_(task) {}

  TrialResult run() {
    const bool tools = options_.mode == StudyMode::kTools;
    const double call =
        tools ? options_.person.call_homing + kOrders * options_.person.call_key : 0.0;
    bool ok = engage();
    for (int i = 0; ok && i < kLinearPhases; ++i) {
      phase_ = static_cast<LinearPhase>(i);
      ok = decide() && start_clock() && wait(call) && call_tools(tools) && act(tools);
    }
    result_.execution_time = elapsed();
    fill_measured(measure_, result_);
    return finish();
  }

 private:
  bool watch(const HapticOrder&) override {
    if (!timed()) return true;
    if (bench_.cell().robot_cycle()) {
      measure_.add(bench_.tip());
      if (options_.keep_trace) result_.trace.push_back({bench_.tip().p, phase_});
    }
    return in_time();
  }

  void begin() override { measure_.add(bench_.tip()); }

  // Takes the same ticks in either mode.
  bool call_tools(bool tools) {
    for (const HapticOrder& order : orders_of(task_, phase_)) {
      if (!step(tools && options_.tools_act ? order : HapticOrder())) return false;
      if (bench_.cell().master().order_result != Reason::kNone) return fail(TrialEnd::kSession);
    }
    return true;
  }

  bool act(bool tools) {
    bench_.clutch(false);
    const OperatorAim aim = aim_of(task_, phase_, tools && options_.tools_act);
    bench_.mind().aim(aim);
    measure_.begin(phase_, bench_.tip().q, bench_.cell().master_state().command.X_SU.q);
    do {
      if (!step()) return false;
    } while (!bench_.mind().arrived());
    measure_.end();
    return (bench_.tip().p - aim.X_SG.p).norm() <= kOffTarget || fail(TrialEnd::kOffTarget);
  }

  LinearTask task_;
  const TrialOptions& options_;
  LinearMeasure measure_;
  LinearPhase phase_ = LinearPhase::kToB;
};

}  // namespace

const char* name_of(StudyMode mode) noexcept { return mode == StudyMode::kFree ? "NV" : "V"; }

const char* name_of(TrialEnd end) noexcept {
  switch (end) {
    case TrialEnd::kDone: return "done";
    case TrialEnd::kTimeOut: return "time-out";
    case TrialEnd::kOffTarget: return "off target";
    case TrialEnd::kSession: return "session lost";
  }
  return "?";
}

OperatorAim aim_of(const LinearTask& task, LinearPhase phase, bool tools) {
  OperatorAim aim;
  aim.X_SG = {phase == LinearPhase::kToC ? task.p_SC : task.p_SB,
              phase == LinearPhase::kToB ? task.q_first : task.q_second()};
  aim.p_S0 = phase == LinearPhase::kToB ? task.p_SA : task.p_SB;
  aim.path = phase != LinearPhase::kTurn;
  aim.stop = aim.path && tools;
  if (!tools) return aim;
  // A line and N-rotation leave the way along the line, a point the turn.
  const Vec3 along = (aim.X_SG.p - aim.p_S0).normalized();
  aim.minds_place = aim.path ? Mat3(along * along.transpose()) : Mat3(Mat3::Zero());
  if (aim.path) aim.minds_turn.setZero();
  return aim;
}

void fill_measured(const LinearMeasure& measure, TrialResult& out) noexcept {
  out.path = measure.path();
  out.position_error = measure.position_error();
  out.position_error_on_lines = measure.position_error_on_lines();
  out.orientation_error = measure.orientation_error();
  out.orientation_error_to_reference = measure.orientation_error_to_reference();
  out.orientation_error_to_nominal = measure.orientation_error_to_nominal();
}

Result<TrialResult> run_linear_trial(const StudyMachine& machine, const TrialOptions& options) {
  if (!machine.scene.task) {
    return Status::error("scene '" + machine.scene.name + "' has no task block");
  }
  const LinearTask& task = *machine.scene.task;
  const auto cell = study_cell(machine, {task.p_SA, task.q_first}, "task.a_mm", options.arm_seed,
                               options.seed + 2);
  if (!cell) return cell.status();
  const auto bench = std::make_unique<StudyBench>(machine, **cell, options.person, options.seed);
  if (Status s = bench->record(machine, name_of(machine.scene.name, options)); !s) return s;
  TrialResult out = LinearTrialRun(task, options, *bench).run();
  if (Status s = bench->finish_recording(name_of(out.end)); !s) return s;
  return out;
}

}  // namespace handrail
