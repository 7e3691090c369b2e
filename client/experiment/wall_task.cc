#include "client/experiment/wall_task.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/lab/walls/wall_report_io.h"

namespace handrail {
namespace {

// Of a velocity from differences of places that are late by a sample now and then: our choice.
constexpr double kNewShare = 0.3;

Vec2 plane_of(const google::protobuf::RepeatedField<double>& v, double unit) {
  return v.size() == 2 ? Vec2(v[0] * unit, v[1] * unit) : Vec2(Vec2::Zero());
}

}  // namespace

WallTick wall_tick_of(const pb::Status& now, const std::vector<std::string>& places) {
  const pb::WallStatus& walls = now.walls();
  WallTick out;
  out.t = now.time_s();
  out.hand = plane_of(walls.hand_mm(), kMm);
  out.device = plane_of(walls.force_n(), 1.0);
  out.handle = -out.device;
  out.contact.proxy = plane_of(walls.proxy_mm(), kMm);
  out.contact.touching = walls.touching();
  out.contact.region = static_cast<std::uint8_t>(walls.region());
  const auto place = std::find(places.begin(), places.end(), walls.place());
  out.effects.locked = walls.locked() && place != places.end();
  if (out.effects.locked) out.effects.place = static_cast<int>(place - places.begin());
  out.turned = walls.turned_rad();
  return out;
}

Status WallTask::simulate(const std::string& subject) {
  // Not the typical one: each subject is another.
  const JoystickPerson person = joystick_person(subject_seed(subject, "person"), 1);
  hand_ = std::make_unique<WallHand>(person, scene_.walls->stages.front().pose);
  return Status::ok();
}

pb::ExperimentTrial WallTask::begin(const TrialNext& next) {
  next_ = next;
  seen_ = ended_ = false;
  started_.reset();
  how_ = TrialEnd::kDone;
  time_ = most_wall_ = sum_ = most_ = apart_ = 0.0;
  touched_ = 0;
  trace_.clear();
  restart();
  pb::ExperimentTrial out;
  out.mutable_walls()->set_number(static_cast<std::uint32_t>(next.number));
  out.mutable_walls()->set_attempt(static_cast<std::uint32_t>(next.attempt));
  return out;
}

void WallTask::see(const pb::Status* now) {
  const double t = now != nullptr ? now->time_s() : now_.t;
  const bool anew = now != nullptr && now->scene_epoch() != epoch_;
  if (timed() && (now == nullptr || !now->has_walls() || anew || t < now_.t))
    return end(TrialEnd::kSession, t);
  if (now == nullptr || !now->has_walls()) return;
  epoch_ = now->scene_epoch();
  const pb::CursorStatus& cursor = now->haptic().cursor();
  held_ = !now->haptic().has_cursor() || cursor.held();
  WallTick tick = wall_tick_of(*now, places_);
  const double dt = tick.t - now_.t;
  if (seen_) tick.velocity = now_.velocity;
  if (seen_ && dt > 0.0)
    tick.velocity += kNewShare * ((tick.hand - now_.hand) / dt - now_.velocity);
  seen_ = true;
  now_ = tick;
  watch(tick);
  if (const std::optional<Vec2> there = ball()) tick.ball = *there;
  if (!timed()) return;
  add(tick);
  if (since_start(t) > kWallLimit) end(TrialEnd::kTimeOut, t);
}

void WallTask::add(const WallTick& now) {
  const double force = now.device.norm();
  most_ = std::max(most_, force);
  apart_ = std::max(apart_, now.depth());
  if (now.contact.touching) {
    most_wall_ = std::max(most_wall_, force);
    sum_ += force;
    ++touched_;
  }
  trace_.push_back(now);
  trace_.back().t = since_start(now.t);
}

TaskPrompt WallTask::prompt() const {
  if (ended_) return {};
  return {(held_ ? "" : "Hold the lever. ") + words(), ball()};
}

void WallTask::act(const pb::Status& now, const TaskHelp&) {
  if (!hand_ || ended_ || !seen_) return;
  const Aim wanted = aim(now_);
  hand_->live(from_seconds(now.time_s()), now_, wanted.p, wanted.v, wanted.lets_go);
}

void WallTask::start_clock(double t) { started_ = t; }

void WallTask::end(TrialEnd how, double t) {
  ended_ = true;
  how_ = how;
  time_ = since_start(t);
}

void WallTask::fill(pb::ExperimentTrial& out) const {
  pb::WallTrial& walls = *out.mutable_walls();
  walls.set_end(name_of(how_));
  walls.set_time_s(time_);
  walls.set_max_wall_force_n(most_wall_);
  if (touched_ > 0) walls.set_mean_wall_force_n(sum_ / touched_);
  walls.set_max_force_n(most_);
  walls.set_max_hand_from_lever_mm(apart_ / kMm);
  measure(walls);
}

std::string WallTask::outcome() const {
  return fmt::format(
      "{}: {:.1f} s, {}, {:.1f} N at the walls at most, the hand {:.1f} mm from the "
      "lever at most",
      name_of(how_), time_, measured(), most_wall_, apart_ / kMm);
}

Status WallTask::write_trace(const std::string& file) const {
  if (trace_.empty()) return Status::ok();
  std::ofstream out(file);
  out << trace_csv(trace_);
  out.close();
  if (out) return Status::ok();
  return Status::error(shown(file, 200) + ": cannot be written: " + std::strerror(errno));
}

}  // namespace handrail
