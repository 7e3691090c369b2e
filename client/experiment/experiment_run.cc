#include "client/experiment/experiment_run.h"

#include <poll.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "client/api/cursor_sender.h"
#include "client/experiment/experiment_results_io.h"
#include "client/experiment/experiment_task.h"
#include "client/experiment/live_status.h"
#include "client/experiment/questionnaire.h"
#include "client/experiment/recording/experiment_recording.h"
#include "client/experiment/standstill.h"
#include "client/experiment/trace_csv.h"
#include "server/base/clock.h"
#include "server/base/operator_name.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/base/version.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr Nanos kSample = 7 * kMillisecond;      // the robot's rate, 141 Hz
constexpr Nanos kAnswer = 5 * kSecond;           // an order's
constexpr Nanos kPromptAgain = kSecond;          // the master forgets one that is not renewed
constexpr Nanos kBallAgain = 33 * kMillisecond;  // a picture of the page's
constexpr Nanos kRetry = 500 * kMillisecond;     // of a master that does not answer, of a full disk

// Everything that lasts as long as one run of the program.
class Experiment {
 public:
  Experiment(const ExperimentWords& words, const ExperimentPlace& place)
      : words_(words),
        place_(place),
        client_(place.master, place.as, place.cancelled),
        recording_(place.master, place.as, recording_label(words.experiment, words.subject),
                   [this](const std::string& text) { say(text); }) {}

  ExitCode run() {
    if (Status s = prepare(); !s) return fail(s.message());
    while (const std::optional<TrialNext> next = next_trial(rules_, order_, trials_made(record_))) {
      if (!make(*next)) return finish();
    }
    say("All trials are made.");
    question();
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
  void prompt(const TaskPrompt& wanted);

  Status prepare();
  Status take_scene(const pb::Status& now);
  Status load_scene(const std::string& name);
  Status suits(const pb::Status& now) const;
  Status begin_file();
  Status order(pb::Request request);
  Status order_for_driver(const pb::Status& now, pb::Request request);
  bool make(const TrialNext& next);
  bool live(const std::string& scene);
  bool write(const pb::ExperimentLine& line);
  void mark(const std::string& what, const TrialNext& next, const std::string& how);
  void question();
  ExitCode finish();

  const ExperimentWords& words_;
  const ExperimentPlace& place_;
  OperatorClient client_;
  ExperimentRecording recording_;
  ExitCode code_ = kExitDone;
  Scene scene_;
  std::unique_ptr<ExperimentTask> task_;
  std::vector<int> order_;
  ExperimentRules rules_;
  ExperimentFile file_;
  ExperimentRecord record_;
  std::string prompted_;
  Standstill standstill_;
  bool trials_begun_ = false;  // trials have begun: a scene between them is ours to change
  Nanos prompt_at_ = 0;        // from when on it is said again
  std::unique_ptr<CursorSender> cursor_;  // null: a person
};

void Experiment::prompt(const TaskPrompt& wanted) {
  const bool is_new = wanted.text != prompted_;
  if (!is_new && monotonic_now() < prompt_at_) return;
  prompted_ = wanted.text;
  prompt_at_ = monotonic_now() + (wanted.ball ? kBallAgain : kPromptAgain);
  pb::Request request;
  request.set_prompt(wanted.text);
  if (wanted.ball) {
    for (const double m : {wanted.ball->x(), wanted.ball->y()}) request.add_ball_mm(m / kMm);
  }
  (void)client_.call(request, kAnswer);
  if (is_new && !wanted.text.empty()) say("  " + wanted.text);
}

Status Experiment::order(pb::Request request) {
  const Result<pb::Reply> reply = client_.call(request, kAnswer);
  if (!reply) return reply.status();
  return reply->done() ? Status::ok() : Status::error("refused: " + reply->reason());
}

// What is ordered for a person is ordered in the name of who drives, as both sit at one machine.
Status Experiment::order_for_driver(const pb::Status& now, pb::Request request) {
  if (!words_.simulated && place_.as.empty() && now.lease().has_holder())
    request.set_as(now.lease().holder());
  return order(std::move(request));
}

Status Experiment::take_scene(const pb::Status& now) {
  const Result<Scene> scene = SceneLibrary().load(scene_of_experiment(words_.experiment));
  if (!scene) return scene.status();
  scene_ = *scene;
  auto task = make_task(words_.experiment, scene_, words_.rig);
  if (!task) return task.status();
  task_ = std::move(*task);
  const auto modes = static_cast<int>(task_->modes().size());
  for (int mode = 0; mode < modes; ++mode) {
    if (now.scene() == task_->scene_of(mode)) return Status::ok();
  }
  return load_scene(scene_.name);
}

// Where the master has another. Once trials have begun nobody drives while it changes, and a master
// that is gone is waited for.
Status Experiment::load_scene(const std::string& name) {
  bool told = false, gone = false;
  Nanos give_up = monotonic_now() + kAnswer;
  for (;;) {
    const Result<pb::Status> now = status_of(client_, kAnswer);
    if (now && now->scene() == name) return Status::ok();
    if (!now && (!trials_begun_ || place_.cancelled())) return now.status();
    if (!now) {
      if (!std::exchange(gone, true)) say("  the master does not answer: " + now.message());
      give_up = monotonic_now() + kAnswer;
      ::poll(nullptr, 0, static_cast<int>(kRetry / kMillisecond));
      continue;
    }
    if (!std::exchange(told, true))
      say("loading the scene " + name + " in place of " + now->scene());
    pb::Request end, load;
    end.set_disengage(true);
    load.set_scene_load(name);
    if (trials_begun_ && now->state() != "off") (void)order_for_driver(*now, end);
    Status loaded = order_for_driver(*now, load);
    if (loaded || !trials_begun_ || monotonic_now() > give_up || place_.cancelled()) return loaded;
    ::poll(nullptr, 0, static_cast<int>(kSample / kMillisecond));
  }
}

// What the task asks of the device, and a simulated person of it.
Status Experiment::suits(const pb::Status& now) const {
  if (words_.simulated && !now.haptic().has_cursor()) {
    return Status::error(
        "a simulated subject leads the page's cursor, and the master's device is '" + now.device() +
        "': start it with device { kind: PAGE }");
  }
  return task_->suits(now);
}

// Who goes on goes on by the rules they began with.
Status Experiment::begin_file() {
  const std::vector<std::string> modes = task_->modes();
  rules_ = task_->rules();
  if (words_.trials != 0) rules_.trials = words_.trials;
  pb::ExperimentSubject subject;
  subject.set_experiment(words_.experiment);
  subject.set_subject(words_.subject);
  subject.set_simulated(words_.simulated);
  for (const int mode : order_of_modes(words_.subject, static_cast<int>(modes.size())))
    subject.add_modes(modes[static_cast<std::size_t>(mode)]);
  subject.set_practice(static_cast<std::uint32_t>(rules_.practice));
  subject.set_trials(static_cast<std::uint32_t>(rules_.trials));
  subject.set_version(program_version());
  subject.set_began(calendar_text(calendar_now()));
  const std::string file = experiment_file(words_.folder, words_.experiment, words_.subject);
  if (Status s = file_.open(file, subject, words_.resume, record_); !s) return s;
  const auto begun = static_cast<int>(record_.subject.trials());
  if (words_.trials != 0 && begun != words_.trials) {
    return Status::error(fmt::format("{}: was begun with --trials {}, expected the same, not {}",
                                     shown(file, 200), begun, words_.trials));
  }
  rules_ = {static_cast<int>(record_.subject.practice()), begun};
  for (const std::string& mode : record_.subject.modes()) {
    const auto known = std::find(modes.begin(), modes.end(), mode);
    if (known == modes.end())
      return Status::error(shown(file, 200) + ": there is no mode '" + shown(mode) + "'");
    order_.push_back(static_cast<int>(known - modes.begin()));
  }
  say("writing to " + file);
  return Status::ok();
}

Status Experiment::prepare() {
  if (const std::string problem = operator_name_problem(words_.subject); !problem.empty())
    return Status::error("--subject: " + problem);
  const Result<pb::Status> now = status_of(client_, kAnswer);
  if (!now) return now.status();
  if (Status s = take_scene(*now); !s) return s;
  if (Status s = suits(*now); !s) return s;
  if (Status s = begin_file(); !s) return s;
  if (!words_.simulated) return Status::ok();
  if (Status s = task_->simulate(words_.subject); !s) return s;
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

// False: it was interrupted, and why has been said.
bool Experiment::live(const std::string& scene) {
  bool told = false;
  while (!task_->ended()) {
    ::poll(nullptr, 0, static_cast<int>((told ? kRetry : kSample) / kMillisecond));
    if (place_.cancelled()) {
      code_ = kExitInterrupted;
      return false;
    }
    const Result<pb::Status> now = status_of(client_, kAnswer);
    if (now && now->scene() != scene) {
      fail("the scene '" + now->scene() + "' was loaded in the middle of a trial, expected '" +
           scene + "': load it again, then go on with --resume");
      return false;
    }
    if (!now && !told) say("  the master does not answer: " + now.message());
    told = !now;
    task_->see(now ? &*now : nullptr);
    if (!now) continue;
    prompt(task_->prompt());
    const std::string held = standstill_.see(prompted_, holds(*now), monotonic_now());
    if (!held.empty()) {
      say("  for a minute the arm has not come further: " + held);
      if (words_.simulated) return fail("the arm does not come further: " + held), false;
    }
    task_->act(*now, {[&](pb::Request r) { return order_for_driver(*now, std::move(r)); },
                      [&](const std::string& text) { say(text); }});
    if (cursor_) cursor_->set(task_->hand());
  }
  return true;
}

// Where in the recording a trial begins or ends.
void Experiment::mark(const std::string& what, const TrialNext& next, const std::string& how) {
  const std::string mode = task_->modes()[static_cast<std::size_t>(next.mode)];
  recording_.mark(trial_mark(what, record_, mode, how));
}

bool Experiment::make(const TrialNext& next) {
  const std::vector<std::string> modes = task_->modes();
  say(fmt::format("Trial {}{}{}", next.number,
                  modes.size() > 1 ? ", " + modes[static_cast<std::size_t>(next.mode)] : "",
                  next.practice ? ", practice" : fmt::format(", attempt {}", next.attempt)));
  const std::string scene = task_->scene_of(next.mode);
  trials_begun_ = true;
  if (const Status there = load_scene(scene); !there) {
    fail(there.message());
    return false;
  }
  recording_.keep();
  // Before it begins: those who mark during a trial are heard.
  mark("begins", next, next.practice ? "practice" : "");
  pb::ExperimentLine line;
  pb::ExperimentTrial& begun = *line.mutable_began();
  begun = task_->begin(next);
  begun.set_practice(next.practice);
  begun.set_began(calendar_text(calendar_now()));
  if (!write(line)) return false;
  pb::ExperimentTrial ended = begun;
  const bool whole = live(scene);
  ended.set_interrupted(!whole);
  if (whole) {
    task_->fill(ended);
    say("  " + task_->outcome());
  }
  mark("ends", next, whole ? end_of(ended) : "interrupted");
  record_.trials.push_back(ended);
  *line.mutable_ended() = ended;
  if (!write(line)) return false;
  const std::string file = trace_file(words_.folder, words_.experiment, words_.subject,
                                      static_cast<int>(record_.trials.size()));
  if (const Status traced = task_->write_trace(file); !traced)
    place_.err << "handrail: experiment: " << traced.message() << '\n';
  return whole;
}

// What a person has not been asked yet, or has not answered.
void Experiment::question() {
  const auto statements = statements_of(words_.experiment);
  const auto open = [&](const Statement& s) { return score_of(record_.answers, s.name) == 0; };
  const auto count_open = [&] { return std::count_if(statements.begin(), statements.end(), open); };
  if (words_.simulated || count_open() == 0) return;
  prompt({"Now answer the questions in the terminal.", std::nullopt});
  place_.err << "How far do you agree, from 1 (not at all) to 5 (fully)?\n";
  std::istringstream nobody;
  pb::ExperimentLine line;
  pb::ExperimentAnswers& answers = *line.mutable_answers();
  answers =
      ask(statements, record_.answers, place_.in != nullptr ? *place_.in : nobody, place_.err);
  answers.set_asked(calendar_text(calendar_now()));
  record_.answers = answers;
  if (write(line) && count_open() > 0) place_.err << "\nnot all is answered: --resume asks again\n";
}

ExitCode Experiment::finish() {
  if (place_.cancelled()) code_ = kExitInterrupted;
  OperatorClient last(place_.master, place_.as);
  pb::Request clear;
  clear.set_prompt("");
  (void)last.call(clear, kSecond);
  recording_.end();
  if (cursor_) {
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
