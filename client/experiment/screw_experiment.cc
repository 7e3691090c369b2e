#include "client/experiment/screw_experiment.h"

#include <spdlog/fmt/fmt.h>

#include <limits>

#include "client/api/status_pose.h"
#include "client/experiment/experiment_results_io.h"
#include "client/experiment/live_status.h"
#include "client/experiment/way_to_a.h"
#include "server/base/clock.h"
#include "server/lab/study/population_io.h"

namespace handrail {
namespace {

constexpr Nanos kScrewOrderPause = 100 * kMillisecond;  // until the status shows what came of it
constexpr Nanos kScrewRefusedPause = 500 * kMillisecond;
constexpr Nanos kRigAnswer = 500 * kMillisecond;  // of a thread that nothing keeps waiting
constexpr Nanos kRigPlays = 2 * kSecond;          // it reads a scene from the disk

RigSight rig_sight_of(const pb::RigMoment& in, std::uint64_t workpiece) {
  RigSight out;
  out.number = in.number();
  out.workpiece = workpiece;
  out.time = in.time_s();
  out.X_ST = pose_of(in.tip());
  out.unbent = kMm * vector_of(in.unbent_mm());
  out.force = vector_of(in.force_n());
  out.turned = in.screw().turned_deg() * kDeg;
  out.off_flats = in.screw().off_flats_deg() * kDeg;
  out.depth = in.screw().has_depth_mm() ? in.screw().depth_mm() * kMm
                                        : -std::numeric_limits<double>::infinity();
  out.slipped = in.screw().slipped();
  out.jammed = in.screw().jammed();
  return out;
}

ScrewTold told_of(const pb::Status& now) {
  const LiveSample sample = sample_of(now);
  const SubjectSight sight = sight_of(now);
  ScrewTold out;
  out.X_ST = sample.X_ST;
  out.contact = vector_of(now.contact_force_n());
  out.X_MH = sight.X_MH;
  out.f_H_M = sight.f_H_M;
  out.spring_M = vector_of(now.spring_force().force_n());
  out.drives = sample.drives;
  out.fault = sight.fault;
  out.clutched = sample.clutched;
  out.tool = sample.position_tool || sample.orientation_tool;
  out.marks = sample.marks;
  return out;
}

}  // namespace

std::string screw_scene(ScrewMode mode) {
  return has_protection(mode) ? "screw-fastening" : "screw-fastening-nc";
}

ScrewExperiment::ScrewExperiment(const Scene& scene, const std::string& rig)
    : scene_(scene),
      place_(rig),
      rig_(rig.empty() ? nullptr : std::make_unique<RigClient>(rig)),
      X_start_(screw_start(scene, OperatorParameters().half_turn)) {}

std::vector<std::string> ScrewExperiment::modes() const {
  std::vector<std::string> out;
  for (int mode = 0; mode < kScrewModes; ++mode)
    out.push_back(name_of(static_cast<ScrewMode>(mode)));
  return out;
}

std::string ScrewExperiment::scene_of(int mode) const {
  return screw_scene(static_cast<ScrewMode>(mode));
}

Status ScrewExperiment::suits(const pb::Status& now) const {
  if (!now.haptic().has_rotation()) {
    return Status::error("the task turns the tip, and the device '" + now.device() +
                         "' does not say how the hand is turned: give the master another device");
  }
  if (!rig_) {
    return Status::error(
        "--rig-socket: expected the status_socket of handrail-rig, which says what happens at the "
        "screw; a real arm has none");
  }
  const Result<pb::RigStatus> there = rig_->look(nullptr, kRigPlays);
  return there ? Status::ok() : there.status();
}

Status ScrewExperiment::simulate(const std::string& subject) {
  const Result<std::string> people = find_population(scene_.name);
  if (!people) return people.status();
  const Result<Population> population = load_population(*people);
  if (!population) return population.status();
  Random random(subject_seed(subject, "person"));
  const OperatorParameters person = population->draw(random);
  subject_ = std::make_unique<ScrewSubject>(scene_, person, random.bits());
  X_start_ = screw_start(scene_, person.half_turn);
  return Status::ok();
}

pb::ExperimentTrial ScrewExperiment::begin(const TrialNext& next) {
  const auto mode = static_cast<ScrewMode>(next.mode);
  next_ = next;
  live_.emplace(scene_, mode, X_start_);
  told_ = ScrewTold();
  lift_.reset();
  closed_ = false;
  if (subject_) subject_->begin(mode, next.number);
  return screw_line(next);
}

bool ScrewExperiment::look(std::vector<RigSight>& out) {
  for (bool all = false; !all;) {
    const Result<pb::RigStatus> status = rig_->look(heard_ == 0 ? nullptr : &heard_, kRigAnswer);
    if (!status) return false;
    all = heard_ == 0 || status->moment_size() == 0;
    for (const pb::RigMoment& moment : status->moment())
      out.push_back(rig_sight_of(moment, status->workpiece()));
    if (status->moment_size() > 0) heard_ = status->moment(status->moment_size() - 1).number();
  }
  return true;
}

void ScrewExperiment::see(const pb::Status* now) {
  told_ = now != nullptr ? told_of(*now) : ScrewTold();
  if (now != nullptr && now->haptic().has_cursor() && !subject_) {
    told_.frees = "hold the hand";
    told_.lets_go = now->haptic().cursor().held();
  }
  std::vector<RigSight> moments;
  if (now == nullptr || !look(moments)) {
    // A rig that starts anew counts anew.
    heard_ = 0;
    live_->lost();
  }
  if (!moments.empty()) newest_ = moments.back();
  live_->see(told_, moments, subject_ ? subject_->phase() : std::nullopt);
}

void ScrewExperiment::say_once(const std::string& text, const TaskHelp& help) {
  if (text != said_ && !text.empty()) help.say("  " + text);
  said_ = text;
}

// Out of the screw first, along it.
Vec3 ScrewExperiment::on_the_way(const Vec3& p_ST) {
  const ScrewWork work(scene_);
  const double high = work.height(p_ST), start = work.height(X_start_.p);
  if (high >= work.task.clear) lift_.reset();
  if (high < work.task.clear && !lift_ && (p_ST - X_start_.p).norm() > kNearA)
    lift_ = p_ST + (start - high) * work.out;
  return lift_.value_or(X_start_.p);
}

// An order that is refused is said once, and made again: what stands against it may go.
void ScrewExperiment::to_start(const pb::Status& now, const TaskHelp& help) {
  if (monotonic_now() < again_at_) return;
  const StartSight sight = start_of(now);
  Pose there = X_start_;
  there.p = on_the_way(sight.X_ST.p);
  there.q = next_turn(scene_, X_start_.q, sight.X_ST.q);
  const auto wanted = order_to_a(sight, there);
  if (!wanted) return;
  const Status given = help.order(*wanted);
  again_at_ = monotonic_now() + (given ? kScrewOrderPause : kScrewRefusedPause);
  if (given && wanted->has_clutch()) closed_ = wanted->clutch();
  say_once(given ? "" : "the arm does not go to the start by itself: " + given.message(), help);
}

// A new workpiece with a screw that nobody has turned.
void ScrewExperiment::loosen(const TaskHelp& help) {
  if (!live_->waits() || live_->loose() || monotonic_now() < loosen_at_) return;
  loosen_at_ = monotonic_now() + kScrewRefusedPause;
  const Status played = rig_->play(scene_of(next_.mode), true, kRigPlays);
  say_once(played ? "" : "the screw is not loosened: " + played.message(), help);
  if (!played) return;
  std::vector<RigSight> moments;
  for (const Nanos give_up = monotonic_now() + kRigAnswer;
       moments.empty() && monotonic_now() < give_up;) {
    heard_ = 0;
    if (!look(moments)) return;
  }
  if (!moments.empty()) live_->loosened(moments.back().workpiece);
}

// Who leads by the page lets the hand go at the start, and the arm stays: the clutch that was
// closed for them is not needed any more, and the next hold leads on.
void ScrewExperiment::open_clutch(const pb::Status& now, const TaskHelp& help) {
  if (!closed_ || subject_ || !now.haptic().has_cursor() || now.haptic().cursor().held()) return;
  if (live_->stage() != ScrewLive::Stage::kReady && !live_->timed()) return;
  pb::Request open;
  open.set_clutch(false);
  closed_ = !help.order(open);
}

void ScrewExperiment::act(const pb::Status& now, const TaskHelp& help) {
  if (!live_->timed()) {
    to_start(now, help);
    loosen(help);
  }
  open_clutch(now, help);
  if (!subject_ || !newest_ || ended()) return;
  for (const pb::Request& request :
       subject_->act(monotonic_now(), told_, *newest_, live_->stage())) {
    if (!help.order(request)) subject_->refused(request);
  }
}

void ScrewExperiment::fill(pb::ExperimentTrial& out) const {
  ScrewResult result = live_->result();
  if (subject_) result.misses = subject_->misses();
  fill_ended(next_, result, out);
  if (!subject_) out.mutable_screw()->clear_misses();
}

std::string ScrewExperiment::outcome() const {
  const ScrewResult& result = live_->result();
  return fmt::format(
      "{}: {:.1f} s, path {:.0f} mm, contact force {:.0f} N in the mean, {:.0f} N at "
      "most",
      name_of(result.end), result.completion_time, 1e3 * result.measured.path,
      result.measured.mean_force, result.measured.max_force);
}

}  // namespace handrail
