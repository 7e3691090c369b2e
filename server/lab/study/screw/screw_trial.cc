#include "server/lab/study/screw/screw_trial.h"

#include <algorithm>
#include <cmath>

#include "devices/rig/world/compliance.h"
#include "server/scene/workpiece_reach.h"

namespace handrail {
namespace {

constexpr double kHover = 3e-3;          // the ball end waits this far above the rim [m]
constexpr double kSixth = 60.0 * kDeg;   // a hexagon fits again after it
constexpr double kWiggle = 10.0 * kDeg;  // either way, to feel for the flats

// The screw of a scene with a screw task.
struct Workpiece {
  Vec3 p_SK;  // centre of the rim
  Vec3 out;   // unit, out of the socket
  double depth;
  double chamfer;
};

HapticOrder tool_order(ToolKind kind) {
  HapticOrder order;
  order.kind = OrderKind::kTool;
  order.tool.kind = kind;
  return order;
}

// A line both ways along the screw's axis.
HapticOrder screw_line_order(const Vec3& p_SA, const Vec3& axis) {
  HapticOrder order = tool_order(ToolKind::kLine);
  order.tool.at_present = false;
  order.tool.p_SA = p_SA;
  order.tool.direction_S = axis;
  return order;
}

HapticOrder tools_off() {
  HapticOrder order;
  order.kind = OrderKind::kToolOff;
  return order;
}

// A trial on the bench.
class ScrewTrialRun : TimedTrial<ScrewResult> {
 public:
  ScrewTrialRun(const StudyMachine& machine, const Workpiece& work,
                const ScrewTrialOptions& options, StudyBench& bench)
      : TimedTrial(options, bench, kScrewLimit),
        task_(*machine.scene.screw),
        work_(work),
        options_(options),
        person_(options.person),
        give_(*machine.scene.simulate),
        dt_(to_seconds(machine.tick)),
        R_SM_(machine.scene.mapping.R_SM),
        q_start_(bench.tip().q) {}

  ScrewResult run() {
    bool ok = engage();
    while (ok) {
      ok = decide() && start_clock() && insert() && turn() && lift();
      // A key lifted from a tight screw ends the trial when it is clear.
      while (ok && tight()) ok = lift();
      ok = ok && turn_back();
    }
    result_.completion_time = elapsed();
    result_.measured = measure_.measured();
    return finish();
  }

 private:
  bool tools() const { return has_tools(options_.mode); }
  const World& world() const { return *bench_.cell().rig().world(); }
  bool tight() const { return world().screw_angle() >= task_.tight; }
  double height(const Vec3& p_S) const { return (p_S - work_.p_SK).dot(work_.out); }
  Vec3 above(double height) const { return work_.p_SK + height * work_.out; }

  bool watch(const HapticOrder& order) override {
    if (order.kind != OrderKind::kNone && bench_.cell().master().order_result != Reason::kNone) {
      return fail(ScrewEnd::kSession);
    }
    if (!timed()) return true;
    const double force = world().on_tip().force.norm();
    measure_.add(dt_, bench_.tip().p, force);
    if (options_.keep_trace && bench_.cell().robot_cycle()) {
      const Vec3 spring = R_SM_ * bench_.cell().master().shares.spring;
      result_.trace.push_back({elapsed(), phase_, bench_.tip().p, world().on_tip().force, spring});
    }
    if (force > kTooHard) return fail(ScrewEnd::kForce);
    // A key lifted out while it is still wound up slips too, which loses nothing.
    if (phase_ == ScrewPhase::kTurn && world().slipped()) return fail(ScrewEnd::kKeyLost);
    if (tight() && height(bench_.tip().p) >= task_.clear) return false;
    return in_time();
  }

  void begin() override { bench_.clutch(false); }

  // One key press each; the hand goes to the keys once and stays there.
  bool call(std::initializer_list<HapticOrder> orders) {
    if (!at_keys_ && !wait(person_.call_homing)) return false;
    at_keys_ = true;
    for (const HapticOrder& order : orders) {
      if (!wait(person_.call_key) || !step(order)) return false;
    }
    return true;
  }

  // Until the operator holds the aim to be reached, or with `until_in` sees the key in. On the line
  // only what is left free is minded.
  bool act(ScrewPhase phase, OperatorAim aim, bool until_in = false) {
    phase_ = phase;
    if (on_line_) {
      aim.minds_place = work_.out * work_.out.transpose();
      aim.minds_turn = phase == ScrewPhase::kInsert ? Mat3(Mat3::Zero()) : aim.minds_place;
    }
    bench_.mind().aim(aim);
    double in_for = 0.0;  // the key has seemed to be in [s]
    do {
      if (!step()) return false;
      in_for = until_in && seems_in() ? in_for + dt_ : 0.0;
      if (in_for >= person_.plan_interval) {
        bench_.leave_off();
        break;
      }
      if (phase == ScrewPhase::kTurn && tight()) break;
    } while (!bench_.mind().arrived());
    return true;
  }

  // The key's orientation, turned clockwise from where it waited.
  Quat turned(double angle) const { return rotation_exp(-angle * work_.out) * q_start_; }
  // By how much from there its flats fit, the nearest of six.
  double fitting() const {
    const double now = -rotation_log(bench_.tip().q * q_start_.conjugate()).dot(work_.out);
    return std::remainder(now + world().off_flats(), kSixth);
  }

  // Looks for the place above the socket.
  bool align() {
    fit_ = fitting();
    OperatorAim aim;
    aim.X_SG = {above(kHover), turned(fit_)};
    aim.tolerance = person_.insert_tolerance;
    return act(ScrewPhase::kAlign, aim);
  }

  // Lets the key down by hand, to where it should be in the socket.
  bool let_down() {
    const double by_sight = height(bench_.mind().seen()) + work_.depth + person_.press;
    const double by_memory = bench_.mind().meant().dot(work_.out) - known_depth_;
    const double way =
        inserted_before_ ? by_sight + person_.depth_memory * (by_memory - by_sight) : by_sight;
    return act(ScrewPhase::kInsert, by_hand(-std::max(way, 1e-3)));
  }

  // The hand goes so far along the axis, whatever the key does.
  OperatorAim by_hand(double up) const {
    OperatorAim aim;
    aim.path = aim.by_hand = true;
    aim.p_S0 = above(0.0);
    aim.X_SG = {above(up), turned(fit_)};
    aim.speed = person_.insert_speed;
    aim.gentle = work_.depth + kHover;
    return aim;
  }

  // A key that is seen not to be in is pushed by what seems to be missing; what did not help is
  // taken back.
  bool push_on() {
    if (seems_in()) return true;
    const double before = bench_.mind().meant().dot(work_.out);
    const double missing = height(bench_.mind().seen()) + work_.depth + person_.press;
    if (!act(ScrewPhase::kInsert, by_hand(-missing), true)) return false;
    if (seems_in()) return true;
    const double pushed = before - bench_.mind().meant().dot(work_.out);
    return pushed < kHardly || act(ScrewPhase::kInsert, by_hand(pushed));
  }

  // As far as the eye tells.
  bool seems_in() const {
    return -height(bench_.mind().seen()) > work_.depth - kShallow * (work_.depth - work_.chamfer);
  }

  // Until the ball end seems to be in: beside the socket, or with its corners across, it is not.
  bool insert() {
    for (;;) {
      if (!line_found_) {
        if (!align()) return false;
        if (tools() && !call({screw_line_order(bench_.cell().slave().X_ST.p, work_.out),
                              tool_order(ToolKind::kNRotation)})) {
          return false;
        }
        on_line_ = tools();
      } else if (!call({tool_order(ToolKind::kNRotation)})) {
        return false;
      }
      if (!let_down() || !push_on()) return false;
      if (!seems_in() && !seek()) return false;
      if (seems_in()) break;
      ++result_.misses;
      if (!give_up()) return false;
    }
    known_depth_ = bench_.mind().meant().dot(work_.out);
    inserted_before_ = true;
    return true;
  }

  // Turns the key to and fro until its corners fit and it drops in.
  bool seek() {
    if (tools() && !call({tool_order(ToolKind::kFRotation)})) return false;
    free_to_turn_ = tools();
    for (const double turn : {kWiggle, -kWiggle}) {
      OperatorAim aim;
      aim.X_SG = {bench_.tip().p, turned(fit_ + turn)};
      aim.tolerance = kAnywhere;
      aim.turn_speed = kSlowly * person_.turn_speed;
      if (!act(ScrewPhase::kSeek, aim, true) || !push_on()) return false;
      if (seems_in()) break;
    }
    return true;
  }

  bool give_up() {
    if (tools() && !call({tools_off()})) return false;
    on_line_ = line_found_ = false;
    free_to_turn_ = false;
    OperatorAim aim;
    aim.X_SG = {above(kHover), turned(fit_)};
    return act(ScrewPhase::kAlign, aim);
  }

  bool turn() {
    if (tools()) {
      // Where the key stands, less what it is bent: the line is not to load it.
      const Vec3 straight = bench_.cell().slave().X_ST.p + give_.at(bench_.cell().slave().X_ST.q) *
                                                               bench_.cell().slave().f_E_S.force;
      if (!line_found_ && !call({screw_line_order(straight, work_.out)})) return false;
      line_found_ = true;
      if (!free_to_turn_ && !call({tool_order(ToolKind::kFRotation)})) return false;
      free_to_turn_ = false;
    }
    OperatorAim aim;
    aim.X_SG = {above(-work_.depth), turned(fit_ + person_.half_turn)};
    aim.way_round = -work_.out;
    aim.tolerance = person_.insert_tolerance;  // the key is watched to stay down
    return act(ScrewPhase::kTurn, aim);
  }

  bool lift() {
    OperatorAim aim;
    aim.path = true;
    aim.p_S0 = above(-work_.depth);
    const double up = tight() ? std::max(person_.lift, task_.clear) + kRoughly : person_.lift;
    aim.X_SG = {above(up), bench_.tip().q};
    aim.tolerance = kRoughly;
    return act(ScrewPhase::kLift, aim);
  }

  bool turn_back() {
    fit_ = fitting();
    OperatorAim aim;
    aim.X_SG = {above(person_.lift), turned(fit_)};
    aim.way_round = work_.out;
    aim.tolerance = kRoughly;
    return act(ScrewPhase::kReturn, aim);
  }

  static constexpr double kSlowly = 0.5;     // of the turning speed, while feeling for the flats
  static constexpr double kShallow = 0.35;   // of the way down the flats still counts as in
  static constexpr double kHardly = 0.5e-3;  // a push of less need not be taken back [m]
  // What counts as arrived where the place does not matter [m].
  static constexpr double kRoughly = 5e-3;
  static constexpr double kAnywhere = 0.1;

  ScrewTask task_;
  Workpiece work_;
  const ScrewTrialOptions& options_;
  const OperatorParameters& person_;
  Compliance give_;
  double dt_;
  Mat3 R_SM_;
  Quat q_start_;
  ScrewMeasure measure_;
  ScrewPhase phase_ = ScrewPhase::kAlign;
  bool at_keys_ = false;
  bool on_line_ = false;       // a line is called
  bool line_found_ = false;    // with tools: the line stands over the socket
  bool free_to_turn_ = false;  // F-rotation has been called already
  bool inserted_before_ = false;
  double fit_ = 0.0;          // the key's turn that fits, as last looked at [rad]
  double known_depth_ = 0.0;  // of the hand when the key was in, along `out` [m]
};

}  // namespace

const char* name_of(ScrewMode mode) noexcept {
  constexpr const char* kNames[kScrewModes] = {"NC-NV", "NC-V", "C-NV", "C-V"};
  return kNames[static_cast<int>(mode)];
}

const char* name_of(ScrewEnd end) noexcept {
  switch (end) {
    case ScrewEnd::kDone: return "done";
    case ScrewEnd::kForce: return "too hard";
    case ScrewEnd::kKeyLost: return "key lost";
    case ScrewEnd::kTimeOut: return "time-out";
    case ScrewEnd::kSession: return "session lost";
  }
  return "?";
}

Result<ScrewResult> run_screw_trial(const StudyMachine& given, const ScrewTrialOptions& options) {
  if (!given.scene.screw) {
    return Status::error("scene '" + given.scene.name + "' has no screw block");
  }
  StudyMachine machine = given;
  machine.scene.bumper.enabled = has_protection(options.mode);
  machine.scene.bumper.form = options.bumper;
  if (!has_protection(options.mode)) machine.scene.guidance.spring = 0.0;
  const HexSocketSpec& socket = *machine.scene.simulate->find<HexSocketSpec>();
  const Workpiece work{socket.X_SK.p, socket.X_SK.q * Vec3::UnitZ(), socket.depth, socket.chamfer};
  if (const auto problem = out_of_reach(machine.scene, options.person.half_turn)) {
    return Status::error("scene '" + machine.scene.name + "': " + to_sentence(*problem));
  }
  // Turned back by half of a half turn: the wrist has the same way to go on either side.
  const Quat q_start =
      rotation_exp(0.5 * options.person.half_turn * work.out) * key_in_socket(machine.scene);
  const auto cell = study_cell(machine, {work.p_SK + machine.scene.screw->start, q_start},
                               "screw.start_mm", options.arm_seed, options.seed + 2);
  if (!cell) return cell.status();
  const auto bench = std::make_unique<StudyBench>(machine, **cell, options.person, options.seed);
  return ScrewTrialRun(machine, work, options, *bench).run();
}

}  // namespace handrail
