#include "client/experiment/rehearsal/wall_rehearsal.h"

#include <memory>
#include <utility>
#include <vector>

#include "client/experiment/experiment_task.h"
#include "client/experiment/trial_order.h"
#include "client/experiment/wall_results_io.h"
#include "devices/page/page_data.h"
#include "devices/page/page_device.h"
#include "server/base/random.h"
#include "server/base/units.h"
#include "server/lab/walls/wall_bench.h"
#include "server/master/haptic_settings.h"
#include "server/master/status_report.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// The runner waits 7 ms and then for its answer, 0.2 ms as measured at the running programs.
constexpr Nanos kWaits = 7 * kMillisecond;
constexpr Nanos kAnswered = 200 * kMicrosecond;
constexpr Nanos kCursorPeriod = 10 * kMillisecond;  // as the runner sends
constexpr Nanos kGrain = 100 * kMicrosecond;        // of the clock of all; divides what is above
constexpr std::uint32_t kHeld = 4;                  // the dead-man, as in CursorSample
// Longer than a trial with the way to its start may take.
constexpr Nanos kGivesUp = 200 * kSecond;

// A master with the page's device and a scene of walls, without threads.
class WallMaster {
 public:
  explicit WallMaster(const Scene& scene) : scene_(scene), run_(loop_scene()) {
    run_.begin(1);
    place_device(run_.scene(), device_);
    // Opening a device that is made up cannot fail.
    static_cast<void>(device_.open());
  }

  // Taken at the next tick.
  void lead(const Pose& X_MC, Nanos now) {
    cursor_.X_MC = X_MC;
    ++cursor_.sequence;
    cursor_.buttons = kHeld;
    cursor_.at = now;
    device_.lead(cursor_);
  }

  void tick(Nanos now) {
    HapticTick given;
    given.dt = to_seconds(kMillisecond);
    given.in.unseen = kMillisecond;
    given.led_by_cursor = true;
    given.in.hand = hand_reading(device_.read(now));
    given.in.order = std::exchange(order_, {});
    if (std::exchange(loads_, false)) {
      run_.change(loop_scene());
      place_device(run_.scene(), device_);
      ++epoch_;
    }
    device_.write(run_.tick(given).out.f_H_M);
  }

  // The server looks at the loop: what it finds is told until it looks again.
  void look(Nanos now) {
    found_ = wall_report(run_);
    looked_ = now;
  }

  // What an operator would be answered.
  pb::Status status() const {
    pb::Status out;
    out.set_time_s(to_seconds(looked_));
    out.set_scene(scene_.name);
    out.set_scene_epoch(epoch_);
    out.mutable_haptic()->mutable_cursor()->set_held(cursor_.sequence > 0);
    pb::WallStatus& walls = *out.mutable_walls();
    show_walls(found_, walls);
    const EffectSpec* detent = effect_of(scene_, EffectKind::kDetent);
    const auto place = static_cast<std::size_t>(found_.place);
    if (detent != nullptr && found_.locked && place < detent->place_names.size()) {
      walls.set_place(detent->place_names[place]);
    }
    return out;
  }

  // Of a runner's orders those that walls know.
  Status order(const pb::Request& request) {
    if (request.has_scene_load()) {
      loads_ = true;
    } else if (request.has_screw_c()) {
      order_.kind = OrderKind::kScrew;
      order_.screw_c = request.screw_c();
    }
    return Status::ok();
  }

 private:
  LoopScene loop_scene() { return loop_scene_of(scene_, page_capabilities(), {}, runs_); }

  const Scene& scene_;
  WallRuns runs_;
  PageDevice device_{page_hand()};
  HapticRun run_;
  CursorSample cursor_;
  WallReport found_;
  Nanos looked_ = 0;
  HapticOrder order_;
  bool loads_ = false;
  std::uint64_t epoch_ = 1;
};

}  // namespace

Result<ExperimentRecord> rehearse(const std::string& experiment, const std::string& subject) {
  const auto scene = SceneLibrary().load(scene_of_experiment(experiment));
  if (!scene) return scene.status();
  if (scene->walls == nullptr) {
    return Status::error(experiment +
                         ": has no walls; the lab's own study of it is in virtual time");
  }
  auto task = make_task(experiment, *scene, "");
  if (!task) return task.status();
  if (Status s = (*task)->simulate(subject); !s) return s;
  const auto master = std::make_unique<WallMaster>(*scene);
  TrialNext next;
  next.number = next.attempt = 1;
  pb::ExperimentTrial trial = (*task)->begin(next);
  // The master's loop, its server, which looks at the loop once a millisecond, and the runner's two
  // threads each began at a moment of its own.
  Random phases(subject_seed(subject, "phases"));
  const auto phase = [&phases] {
    return kGrain *
           static_cast<Nanos>(phases.uniform() * static_cast<double>(kMillisecond / kGrain));
  };
  const Nanos looks = phase();
  const TaskHelp help{[&](const pb::Request& order) { return master->order(order); },
                      [](const std::string&) {}};
  pb::Status told;
  bool seen = false;
  Nanos asks = kMillisecond + phase(), answered = kForever, leads = phase();
  for (Nanos now = 0; !(*task)->ended() && now < kGivesUp; now += kGrain) {
    if (now % kMillisecond == 0) master->tick(now);
    if (now % kMillisecond == looks) master->look(now);
    if (now == asks) {
      told = master->status();
      answered = now + kAnswered;
    }
    if (now == answered) {
      (*task)->see(&told);
      (*task)->act(told, help);
      seen = true;
      asks = now + kWaits;
    }
    if (now == leads) {
      if (seen) master->lead((*task)->hand(), now);
      leads = now + kCursorPeriod;
    }
  }
  if (!(*task)->ended())
    return Status::error(experiment + ": " + subject + " did not come to an end");
  (*task)->fill(trial);
  ExperimentRecord out;
  out.subject.set_experiment(experiment);
  out.subject.set_subject(subject);
  out.subject.set_simulated(true);
  out.subject.set_trials(1);
  out.trials.push_back(std::move(trial));
  return out;
}

Result<std::string> rehearsal_text(const std::string& experiment, int people, bool json,
                                   const std::function<bool()>& cancelled) {
  std::vector<ExperimentRecord> all;
  for (int i = 1; i <= people; ++i) {
    if (cancelled()) return Status::error("cancelled");
    auto one = rehearse(experiment, "p" + std::to_string(i));
    if (!one) return one.status();
    all.push_back(std::move(*one));
  }
  return wall_results_text(all, json);
}

}  // namespace handrail
