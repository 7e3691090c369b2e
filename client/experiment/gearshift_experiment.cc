#include "client/experiment/gearshift_experiment.h"

#include <spdlog/fmt/fmt.h>

namespace handrail {

GearshiftExperiment::GearshiftExperiment(const Scene& scene, GearGate gate)
    : WallTask(scene, gate.names()), gate_(std::move(gate)) {}

void GearshiftExperiment::restart() {
  at_n_ = false;
  judge_.reset();
  driver_.reset();
  counted_ = next_ = 0;
  wrong_ = 0;
  wrong_gear_.clear();
}

void GearshiftExperiment::watch(const WallTick& now) {
  if (!timed()) {
    const bool in_n = (now.hand - gate_.neutral()).norm() < gate_.home();
    if (in_n && held()) {
      at_n_ = true;
      judge_.emplace(gate_);
    } else if (at_n_) {
      if (held()) start_clock(now.t);
      at_n_ = held();
    }
  }
  if (!judge_) return;
  judge_->see(now);
  if (!timed()) return;
  const std::vector<std::string>& visited = judge_->so_far();
  for (; counted_ < visited.size(); ++counted_) {
    const std::string& gear = visited[counted_];
    if (gear == "N" || (next_ > 0 && gear == gate_.names()[next_ - 1])) continue;
    const bool right = !all_in() && gear == gate_.names()[next_];
    next_ += right;
    wrong_ += !right;
    wrong_gear_ = right ? "" : gear;
  }
  if (all_in() && judge_->rests_in_neutral()) end(TrialEnd::kDone, now.t);
}

std::string GearshiftExperiment::words() const {
  if (!timed()) {
    return at_n_ ? fmt::format("In N. The clock starts as the lever leaves it: to {}.",
                               gate_.names().front())
                 : "Bring the lever to N, in the middle.";
  }
  const std::string wrong =
      wrong_gear_.empty() ? "" : fmt::format("{} is the wrong gear. ", wrong_gear_);
  if (all_in()) return wrong + "Back to N, and rest there.";
  return fmt::format("{}{}Now {}.", wrong,
                     next_ > 0 && wrong.empty() ? gate_.names()[next_ - 1] + " is in. " : "",
                     gate_.names()[next_]);
}

WallTask::Aim GearshiftExperiment::aim(const WallTick& now) {
  if (!at_n_ && !timed()) return {gate_.neutral()};
  if (!driver_) {
    driver_.emplace(gate_, pace());
    set_out_ = now.t;
  }
  WallTick tick = now;
  tick.t -= set_out_;
  driver_->drive(tick);
  return {driver_->p(), driver_->v(), driver_->lets_go()};
}

void GearshiftExperiment::measure(pb::WallTrial& out) const {
  out.clear_visited();
  if (judge_) {
    for (const std::string& gear : judge_->visited()) out.add_visited(gear);
  }
  out.set_wrong_gears(static_cast<std::uint32_t>(wrong_));
}

std::string GearshiftExperiment::measured() const {
  std::string way;
  for (const std::string& gear : judge_->visited()) way += (way.empty() ? "" : "-") + gear;
  return way;
}

}  // namespace handrail
