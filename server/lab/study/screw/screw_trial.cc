#include "server/lab/study/screw/screw_trial.h"

#include "server/lab/study/screw/screw_person.h"
#include "server/scene/workpiece_reach.h"

namespace handrail {
namespace {

// A trial on the bench.
class ScrewTrialRun : TimedTrial<ScrewResult>, ScrewPlace {
 public:
  ScrewTrialRun(const StudyMachine& machine, const ScrewWork& work,
                const ScrewTrialOptions& options, StudyBench& bench)
      : TimedTrial(options, bench, kScrewLimit),
        options_(options),
        work_(work),
        R_SM_(machine.scene.mapping.R_SM),
        dt_(to_seconds(machine.tick)),
        judge_(work),
        person_(*this, work, Compliance(*machine.scene.simulate), options.person,
                {has_tools(options.mode), pause_of(options), dt_}) {}

  ScrewResult run() {
    if (engage()) person_.fasten();
    result_.completion_time = elapsed();
    result_.measured = judge_.measured();
    result_.misses = person_.misses();
    return finish();
  }

 private:
  const World& world() const { return *bench_.cell().rig().world(); }

  bool pass(const ScrewKey& key) override {
    HapticOrder order;
    if (key.act == ScrewKey::Act::kTool) order.kind = OrderKind::kTool;
    if (key.act == ScrewKey::Act::kToolsOff) order.kind = OrderKind::kToolOff;
    order.tool = key.tool;
    return step(order);
  }
  void start_clock() override { TimedTrial::start_clock(); }
  double now() const override { return bench_.now(); }
  OperatorModel& mind() override { return bench_.mind(); }
  void leave_off() override { bench_.leave_off(); }
  Pose tip() const override { return bench_.tip(); }
  Pose told_tip() const override { return bench_.cell().slave().X_ST; }
  Vec3 told_force() const override { return bench_.cell().slave().f_E_S.force; }
  double off_flats() const override { return world().off_flats(); }
  bool tight() const override { return work_.is_tight(world().screw_angle()); }

  bool watch(const HapticOrder& order) override {
    if (order.kind != OrderKind::kNone && bench_.cell().master().order_result != Reason::kNone) {
      return fail(ScrewEnd::kSession);
    }
    if (!timed()) return true;
    const Wrench& on_tip = world().on_tip();
    if (options_.keep_trace && bench_.cell().robot_cycle()) {
      const Vec3 spring = R_SM_ * bench_.cell().master().shares.spring;
      result_.trace.push_back({elapsed(), person_.phase(), bench_.tip().p, on_tip.force, spring});
    }
    const auto end = judge_.add(dt_, elapsed(),
                                {bench_.tip().p, on_tip.force.norm(), world().screw_angle(),
                                 world().slipped(), person_.phase() == ScrewPhase::kTurn});
    return !end || fail(*end);
  }
  void begin() override { bench_.clutch(false); }

  const ScrewTrialOptions& options_;
  ScrewWork work_;
  Mat3 R_SM_;
  double dt_;
  ScrewJudge judge_;
  ScrewPerson person_;
};

}  // namespace

const char* name_of(ScrewMode mode) noexcept {
  constexpr const char* kNames[kScrewModes] = {"NC-NV", "NC-V", "C-NV", "C-V"};
  return kNames[static_cast<int>(mode)];
}

void set_protection(bool protection, Scene& scene) noexcept {
  scene.bumper.enabled = protection;
  if (!protection) scene.guidance.spring = 0.0;
}

Pose screw_start(const Scene& scene, double half_turn) noexcept {
  const ScrewWork work(scene);
  // The wrist has the same way to go on either side.
  return {work.p_SK + work.task.start,
          rotation_exp(0.5 * half_turn * work.out) * key_in_socket(scene)};
}

Result<ScrewResult> run_screw_trial(const StudyMachine& given, const ScrewTrialOptions& options) {
  if (!given.scene.screw) {
    return Status::error("scene '" + given.scene.name + "' has no screw block");
  }
  StudyMachine machine = given;
  machine.scene.bumper.form = options.bumper;
  set_protection(has_protection(options.mode), machine.scene);
  const ScrewWork work(machine.scene);
  if (const auto problem = out_of_reach(machine.scene, options.person.half_turn)) {
    return Status::error("scene '" + machine.scene.name + "': " + to_sentence(*problem));
  }
  const auto cell = study_cell(machine, screw_start(machine.scene, options.person.half_turn),
                               "screw.start_mm", options.arm_seed, options.seed + 2);
  if (!cell) return cell.status();
  const auto bench = std::make_unique<StudyBench>(machine, **cell, options.person, options.seed);
  if (!machine.recording.folder.empty() && !has_protection(options.mode)) {
    machine.recording.scene_text = text_without_protection(machine.recording.scene_text);
  }
  if (Status s = bench->record(machine, name_of(machine.scene.name, options)); !s) return s;
  ScrewResult out = ScrewTrialRun(machine, work, options, *bench).run();
  if (Status s = bench->finish_recording(name_of(out.end)); !s) return s;
  return out;
}

}  // namespace handrail
