#include "client/experiment/linear_experiment.h"

#include <spdlog/fmt/fmt.h>

#include "client/experiment/experiment_results_io.h"
#include "client/experiment/live_status.h"
#include "client/experiment/way_to_a.h"
#include "server/base/clock.h"
#include "server/lab/study/population_io.h"

namespace handrail {
namespace {

constexpr Nanos kOrderPause = 100 * kMillisecond;  // until the status shows what came of it
constexpr Nanos kRefusedPause = 500 * kMillisecond;

}  // namespace

std::vector<std::string> LinearExperiment::modes() const {
  return {name_of(StudyMode::kFree), name_of(StudyMode::kTools)};
}

Status LinearExperiment::suits(const pb::Status& now) const {
  if (now.haptic().has_rotation()) return Status::ok();
  return Status::error("the task turns the tip, and the device '" + now.device() +
                       "' does not say how the hand is turned: give the master another device");
}

Status LinearExperiment::simulate(const std::string& subject) {
  const Result<std::string> people = find_population(scene_.name);
  if (!people) return people.status();
  const Result<Population> population = load_population(*people);
  if (!population) return population.status();
  Random random(subject_seed(subject, "person"));
  const OperatorParameters person = population->draw(random);
  subject_ = std::make_unique<SimulatedSubject>(scene_, person, random.bits());
  return Status::ok();
}

pb::ExperimentTrial LinearExperiment::begin(const TrialNext& next) {
  const auto mode = static_cast<StudyMode>(next.mode);
  next_ = next;
  live_.emplace(*scene_.task, mode);
  sample_ = LiveSample();
  trace_.clear();
  if (subject_) subject_->begin(mode, next.number);
  return trial_line(next);
}

void LinearExperiment::see(const pb::Status* now) {
  if (now != nullptr) {
    sample_ = sample_of(*now);
    if (now->haptic().has_cursor() && !subject_) {
      sample_.frees = "hold the hand";
      sample_.lets_go = now->haptic().cursor().held();
    }
  } else {
    sample_.drives = false;
  }
  live_->see(sample_);
  if (now != nullptr && sample_.drives && live_->timed())
    trace_.push_back(row_of(*now, live_->phase()));
}

// An order that is refused is said once, and made again: what stands against it may go.
void LinearExperiment::to_a(const pb::Status& now, const TaskHelp& help) {
  if (monotonic_now() < again_at_) return;
  StartSight sight = start_of(now);
  sight.gripper = now.has_gripper();
  sight.closed = now.gripper() == "closed";
  const auto wanted = order_to_a(sight, {scene_.task->p_SA, scene_.task->q_first});
  if (!wanted) return;
  const Status given = help.order(*wanted);
  again_at_ = monotonic_now() + (given ? kOrderPause : kRefusedPause);
  if (given && wanted->has_clutch()) closed_ = wanted->clutch();
  if (!given && !refused_) help.say("  the arm does not go to A by itself: " + given.message());
  refused_ = !given;
}

// Who leads by the page lets the hand go at A, and the arm stays: the clutch that was closed for
// them is not needed any more, and the next hold leads on.
void LinearExperiment::open_clutch(const pb::Status& now, const TaskHelp& help) {
  if (!closed_ || subject_ || !now.haptic().has_cursor() || now.haptic().cursor().held()) return;
  pb::Request open;
  open.set_clutch(false);
  closed_ = !help.order(open);
}

void LinearExperiment::act(const pb::Status& now, const TaskHelp& help) {
  if (!live_->timed()) to_a(now, help);
  open_clutch(now, help);
  if (!subject_) return;
  for (const pb::Request& request : subject_->step(monotonic_now(), sight_of(now), *live_)) {
    if (!help.order(request)) subject_->refused(request);
  }
}

void LinearExperiment::fill(pb::ExperimentTrial& out) const {
  fill_ended(next_, live_->result(), out);
}

std::string LinearExperiment::outcome() const {
  const TrialResult& result = live_->result();
  return fmt::format("{}: {:.1f} s, path {:.0f} mm, off the lines by {:.1f} mm at most",
                     name_of(result.end), result.execution_time, 1e3 * result.path,
                     1e3 * result.position_error);
}

}  // namespace handrail
