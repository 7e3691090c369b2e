#include "client/experiment/experiment_run.h"

#include <poll.h>
#include <spdlog/fmt/fmt.h>

#include <memory>
#include <optional>

#include "client/experiment/cursor_sender.h"
#include "client/experiment/experiment_results_io.h"
#include "client/experiment/live_status.h"
#include "client/experiment/simulated_subject.h"
#include "client/experiment/trace_csv.h"
#include "client/experiment/way_to_a.h"
#include "server/base/clock.h"
#include "server/base/operator_name.h"
#include "server/base/plain_text.h"
#include "server/base/version.h"
#include "server/lab/study/population_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr Nanos kSample = 7 * kMillisecond;        // the robot's rate, 141 Hz
constexpr Nanos kAnswer = 5 * kSecond;             // an order's
constexpr Nanos kOrderPause = 100 * kMillisecond;  // until the status shows what came of it
constexpr Nanos kPromptAgain = kSecond;            // the master forgets one that is not renewed
constexpr Nanos kRetry = 500 * kMillisecond;  // of a master that does not answer, of a full disk

// Everything that lasts as long as one run of the program.
class Experiment {
 public:
  Experiment(const ExperimentWords& words, const ExperimentPlace& place)
      : words_(words), place_(place), client_(place.master, place.as, place.cancelled) {}

  ExitCode run() {
    if (Status s = prepare(); !s) return fail(s.message());
    while (const std::optional<TrialNext> next = next_trial(rules_, order_, trials_made(record_))) {
      if (!make(*next)) return finish();
    }
    say("All trials are made.");
    return finish();
  }

 private:
  ExitCode fail(const std::string& problem) {
    place_.err << "handrail: experiment: " << problem << '\n';
    code_ = place_.cancelled() ? kExitInterrupted : kExitRefused;
    return code_;
  }

  // Whoever is there sees it, and who looks on.
  void say(const std::string& text) {
    if (!words_.json) place_.out << text << std::endl;
  }
  void prompt(const std::string& text) {
    const bool is_new = text != prompted_;
    if (!is_new && monotonic_now() < prompt_at_) return;
    prompted_ = text;
    prompt_at_ = monotonic_now() + kPromptAgain;
    pb::Request request;
    request.set_prompt(text);
    (void)client_.call(request, kAnswer);
    if (is_new && !text.empty()) say("  " + text);
  }

  Status prepare();
  Status load_scene(const pb::Status& now);
  Status suits(const pb::Status& now) const;
  Status order(const pb::Request& request);
  bool make(const TrialNext& next);
  bool live(LinearLive& trial, std::vector<TraceRow>& trace);
  void speak_for_driver(const pb::Status& now, pb::Request& request) const;
  void to_a(const pb::Status& now);
  void open_clutch(const pb::Status& now);
  void act(const LinearLive& trial, const pb::Status& now);
  bool write(const pb::ExperimentLine& line);
  ExitCode finish();

  const ExperimentWords& words_;
  const ExperimentPlace& place_;
  OperatorClient client_;
  ExitCode code_ = kExitDone;
  Scene scene_;
  std::vector<int> order_;
  ExperimentRules rules_;
  ExperimentFile file_;
  ExperimentRecord record_;
  std::string prompted_;
  Nanos prompt_at_ = 0;  // from when on it is said again
  Nanos again_at_ = 0;
  bool closed_ = false;   // the clutch, for who waits at A
  bool refused_ = false;  // and that was said
  std::unique_ptr<CursorSender> cursor_;
  std::unique_ptr<SimulatedSubject> subject_;
};

Status Experiment::order(const pb::Request& request) {
  const Result<pb::Reply> reply = client_.call(request, kAnswer);
  if (!reply) return reply.status();
  return reply->done() ? Status::ok() : Status::error("refused: " + reply->reason());
}

Status Experiment::load_scene(const pb::Status& now) {
  const Result<Scene> scene = SceneLibrary().load(words_.experiment);
  if (!scene) return scene.status();
  if (!scene->task) return Status::error(scene->file + ": the scene has no task block");
  scene_ = *scene;
  if (now.scene() == scene_.name) return Status::ok();
  say("loading the scene " + scene_.name + " in place of " + now.scene());
  pb::Request load;
  load.set_scene_load(scene_.name);
  return order(load);
}

// What the task asks of the device, and a simulated person of it.
Status Experiment::suits(const pb::Status& now) const {
  if (!now.haptic().has_rotation()) {
    return Status::error("the task turns the tip, and the device '" + now.device() +
                         "' does not say how the hand is turned: give the master another device");
  }
  if (words_.simulated && !now.haptic().has_cursor()) {
    return Status::error(
        "a simulated subject leads the page's cursor, and the master's device is '" + now.device() +
        "': start it with device { kind: PAGE }");
  }
  return Status::ok();
}

Status Experiment::prepare() {
  if (const std::string problem = operator_name_problem(words_.subject); !problem.empty())
    return Status::error("--subject: " + problem);
  const Result<pb::Status> now = status_of(client_, kAnswer);
  if (!now) return now.status();
  if (Status s = load_scene(*now); !s) return s;
  if (Status s = suits(*now); !s) return s;
  pb::ExperimentSubject subject;
  subject.set_experiment(words_.experiment);
  subject.set_subject(words_.subject);
  subject.set_simulated(words_.simulated);
  order_ = order_of_modes(words_.subject, kStudyModes);
  for (const int mode : order_) subject.add_modes(name_of(static_cast<StudyMode>(mode)));
  if (words_.trials != 0) rules_.trials = words_.trials;
  subject.set_practice(static_cast<std::uint32_t>(rules_.practice));
  subject.set_trials(static_cast<std::uint32_t>(rules_.trials));
  subject.set_version(program_version());
  subject.set_began(calendar_text(calendar_now()));
  const std::string file = experiment_file(words_.folder, words_.experiment, words_.subject);
  if (Status s = file_.open(file, subject, words_.resume, record_); !s) return s;
  // Who goes on goes on by the rules they began with.
  const auto begun = static_cast<int>(record_.subject.trials());
  if (words_.trials != 0 && begun != words_.trials) {
    return Status::error(fmt::format("{}: was begun with --trials {}, expected the same, not {}",
                                     shown(file, 200), begun, words_.trials));
  }
  rules_ = {static_cast<int>(record_.subject.practice()), begun};
  say("writing to " + file);
  if (!words_.simulated) return Status::ok();
  const Result<std::string> people = find_population(words_.experiment);
  if (!people) return people.status();
  const Result<Population> population = load_population(*people);
  if (!population) return population.status();
  Random random(seed_of_subject(words_.subject));
  const OperatorParameters person = population->draw(random);
  subject_ = std::make_unique<SimulatedSubject>(scene_, person, random.bits());
  cursor_ = std::make_unique<CursorSender>(place_.master, place_.as);
  pb::Request take;
  take.mutable_lease()->set_act(pb::LeaseOrder::TAKE);
  return order(take);
}

// On the disk, or tried again until it is or somebody gives up: then it is printed.
bool Experiment::write(const pb::ExperimentLine& line) {
  bool told = false;
  for (;;) {
    const Status written = file_.append(line);
    if (written) return true;
    if (!told) {
      place_.err << "handrail: experiment: " << written.message()
                 << "; it is tried again until there is room, Ctrl-C gives up\n";
    }
    told = true;
    if (place_.cancelled()) {
      place_.err << "not written: " << line_of(line);
      code_ = kExitInterrupted;
      return false;
    }
    ::poll(nullptr, 0, static_cast<int>(kRetry / kMillisecond));
  }
}

// What is ordered for a person is ordered in the name of who drives, as both sit at one machine.
void Experiment::speak_for_driver(const pb::Status& now, pb::Request& request) const {
  if (!subject_ && place_.as.empty() && now.lease().has_holder())
    request.set_as(now.lease().holder());
}

// An order that is refused is said once, and made again: what stands against it may go.
void Experiment::to_a(const pb::Status& now) {
  if (monotonic_now() < again_at_) return;
  auto wanted = order_to_a(start_of(now), {scene_.task->p_SA, scene_.task->q_first});
  if (!wanted) return;
  speak_for_driver(now, *wanted);
  const Status given = order(*wanted);
  again_at_ = monotonic_now() + kOrderPause;
  if (given) {
    if (wanted->has_clutch()) closed_ = wanted->clutch();
    refused_ = false;
    return;
  }
  again_at_ = monotonic_now() + kRetry;
  if (!refused_) say("  the arm does not go to A by itself: " + given.message());
  refused_ = true;
}

// Who leads by the page lets the hand go at A, and the arm stays: the clutch that was closed for
// them is not needed any more, and the next hold leads on.
void Experiment::open_clutch(const pb::Status& now) {
  if (!closed_ || subject_ || !now.haptic().has_cursor() || now.haptic().cursor().held()) return;
  pb::Request open;
  open.set_clutch(false);
  speak_for_driver(now, open);
  closed_ = !order(open);
}

// One sample for the orders of a simulated person.
void Experiment::act(const LinearLive& trial, const pb::Status& now) {
  if (!subject_) return;
  for (const pb::Request& request : subject_->step(monotonic_now(), sight_of(now), trial)) {
    if (!order(request)) subject_->refused(request);
  }
  cursor_->set(subject_->hand());
}

// False: it was interrupted, and why has been said.
bool Experiment::live(LinearLive& trial, std::vector<TraceRow>& trace) {
  bool told = false;
  LiveSample sample;
  while (trial.stage() != LinearLive::Stage::kEnded) {
    ::poll(nullptr, 0, static_cast<int>((told ? kRetry : kSample) / kMillisecond));
    if (place_.cancelled()) {
      code_ = kExitInterrupted;
      return false;
    }
    const Result<pb::Status> now = status_of(client_, kAnswer);
    if (now && now->scene() != scene_.name) {
      fail("the scene '" + now->scene() + "' was loaded in the middle of a trial, expected '" +
           scene_.name + "': load it again, then go on with --resume");
      return false;
    }
    if (!now && !told) say("  the master does not answer: " + now.message());
    told = !now;
    if (now) {
      sample = sample_of(*now);
      if (now->haptic().has_cursor() && !subject_) {
        sample.frees = "hold the hand";
        sample.lets_go = now->haptic().cursor().held();
      }
    } else {
      sample.drives = false;
    }
    trial.see(sample);
    if (!now) continue;
    prompt(trial.prompt());
    if (sample.drives && trial.timed()) trace.push_back(row_of(*now, trial.phase()));
    if (!trial.timed()) to_a(*now);
    open_clutch(*now);
    act(trial, *now);
  }
  return true;
}

bool Experiment::make(const TrialNext& next) {
  const auto mode = static_cast<StudyMode>(next.mode);
  say(fmt::format("Trial {}, {}{}", next.number, name_of(mode),
                  next.practice ? ", practice" : fmt::format(", attempt {}", next.attempt)));
  pb::ExperimentLine line;
  pb::ExperimentTrial& begun = *line.mutable_began();
  begun = trial_line(next, calendar_text(calendar_now()));
  if (!write(line)) return false;
  LinearLive trial(*scene_.task, mode);
  if (subject_) subject_->begin(mode, next.number);
  std::vector<TraceRow> trace;
  pb::ExperimentTrial ended = begun;
  const bool whole = live(trial, trace);
  if (whole) {
    fill_ended(next, trial.result(), ended);
    say(fmt::format("  {}: {:.1f} s, path {:.0f} mm, off the lines by {:.1f} mm at most",
                    name_of(trial.result().end), trial.result().execution_time,
                    1e3 * trial.result().path, 1e3 * trial.result().position_error));
  } else {
    ended.set_interrupted(true);
  }
  record_.trials.push_back(ended);
  *line.mutable_ended() = ended;
  if (!write(line)) return false;
  const std::string file = trace_file(words_.folder, words_.experiment, words_.subject,
                                      static_cast<int>(record_.trials.size()));
  if (const Status traced = write_trace(file, trace); !traced)
    place_.err << "handrail: experiment: " << traced.message() << '\n';
  return whole;
}

ExitCode Experiment::finish() {
  if (place_.cancelled()) code_ = kExitInterrupted;
  OperatorClient last(place_.master, place_.as);
  pb::Request clear;
  clear.set_prompt("");
  (void)last.call(clear, kSecond);
  if (subject_) {
    for (const bool drive : {true, false}) {
      pb::Request request;
      if (drive) {
        request.set_disengage(true);
      } else {
        request.mutable_lease()->set_act(pb::LeaseOrder::RELEASE);
      }
      (void)last.call(request, kSecond);
    }
    cursor_.reset();
  }
  if (code_ == kExitInterrupted)
    say("interrupted; --resume goes on with the trial that was not finished");
  if (code_ == kExitDone) place_.out << results_text({record_}, words_.json);
  return code_;
}

}  // namespace

ExitCode run_experiment(const ExperimentWords& words, const ExperimentPlace& place) {
  return Experiment(words, place).run();
}

}  // namespace handrail
