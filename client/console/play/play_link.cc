#include "client/console/play/play_link.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "client/console/play/played_status.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

// As of a live master's statuses.
constexpr Nanos kMomentPeriod = kSecond / 60;

pb::RecordingMark::Kind mark_kind(pb::RecordedEvent::Kind kind) {
  switch (kind) {
    case pb::RecordedEvent::MARK: return pb::RecordingMark::MARK;
    case pb::RecordedEvent::STOP: return pb::RecordingMark::STOP;
    case pb::RecordedEvent::FAULT: return pb::RecordingMark::FAULT;
    case pb::RecordedEvent::LOST:
    case pb::RecordedEvent::DISK: break;
  }
  return pb::RecordingMark::GAP;
}

}  // namespace

pb::RecordingNews recording_news(const RecordingReader& recording) {
  pb::RecordingNews out;
  out.set_file(shown(recording.path(), 4096));
  out.set_program(shown(recording.start().program()));
  out.set_version(shown(recording.start().version()));
  out.set_begins_s(to_seconds(recording.begins()));
  out.set_length_s(to_seconds(recording.ends() - recording.begins()));
  if (!recording.damage().empty()) out.set_damage(shown(recording.damage(), 400));
  for (const RecordingEvent& each : recording.events()) {
    pb::RecordingMark& mark = *out.add_mark();
    const Nanos at = std::clamp(each.calendar, recording.begins(), recording.ends());
    mark.set_at_s(to_seconds(at - recording.begins()));
    mark.set_kind(mark_kind(each.event.kind()));
    mark.set_text(shown(each.event.text(), 200));
    if (each.event.has_who()) mark.set_who(shown(each.event.who()));
  }
  if (recording.events_left_out() > 0) {
    out.set_marks_left_out(static_cast<std::uint32_t>(recording.events_left_out()));
  }
  out.set_slowest(kSlowestPlay);
  out.set_fastest(kFastestPlay);
  return out;
}

PlayLink::PlayLink(std::unique_ptr<RecordingReader> recording, Post post, Told tell)
    : recording_(std::move(recording)),
      post_(std::move(post)),
      tell_(std::move(tell)),
      clock_(recording_->ends() - recording_->begins()) {
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { run(); });
}

PlayLink::~PlayLink() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

Result<PlayState> PlayLink::play(const PlayOrder& order) {
  const std::lock_guard lock(mutex_);
  const Nanos now = monotonic_now();
  if (Status taken = clock_.take(order, now); !taken) return taken;
  ordered_ = true;
  wake_.notify_one();
  return clock_.state(now);
}

void PlayLink::run() {
  std::unique_lock lock(mutex_);
  for (Nanos next = monotonic_now(); !ending_;) {
    ordered_ = false;
    const PlayState state = clock_.state(monotonic_now());
    lock.unlock();
    show(state);
    lock.lock();
    // After a slow disk at most one moment is made up for, so that the rate stays what it is; and
    // what an order had shown at once is no turn of those that come by themselves.
    const Nanos now = monotonic_now();
    next = std::clamp(next + kMomentPeriod, now - kMomentPeriod, now + kMomentPeriod);
    wake_.wait_for(lock, std::chrono::nanoseconds(std::max<Nanos>(next - now, 0)),
                   [this] { return ending_ || ordered_; });
  }
}

void PlayLink::show(const PlayState& state) {
  const Nanos asked = monotonic_now();
  const auto moment = recording_->at(recording_->begins() + state.position);
  if (!moment) {
    reply_ = Status::error(recording_->path() + ": " + moment.message());
    shown_.reset();
  } else if (shown_ != (*moment)->calendar) {
    take_scene(scene_number(recording_->of_master(), **moment));
    reply_ = reply_of(**moment);
    shown_ = (*moment)->calendar;
  }
  post_([this, reply = reply_, asked, state] { tell_.moment(reply, asked, state); });
}

// One scene is kept: a painted one is large.
void PlayLink::take_scene(std::uint32_t number) {
  if (scene_ == number) return;
  scene_ = number;
  scenes_ = std::make_unique<RecordedScenes>(std::vector<Override>{}, "");
  std::string name = "scene " + std::to_string(number);
  const auto read = [&]() -> Result<ReadScene> {
    const auto recorded = recording_->scene(number);
    if (!recorded) return recorded.status();
    name = shown(recorded->name());
    if (Status added = scenes_->add(*recorded); !added) return added;
    return with_picture(*scenes_->find(number));
  };
  auto scene = read();
  post_([this, name, scene = std::move(scene)] { tell_.scene(name, scene); });
}

Result<pb::Reply> PlayLink::reply_of(const RecordingMoment& moment) {
  const Scene* scene = scene_ ? scenes_->find(*scene_) : nullptr;
  auto status = played_status(recording_->start(), recording_->of_master(), moment, scene);
  if (!status) return Status::error(recording_->path() + ": " + status.message());
  add_mark(moment.calendar, *status);
  pb::Reply out;
  out.set_done(true);
  *out.mutable_status() = std::move(*status);
  return out;
}

// The newest mark of that time.
void PlayLink::add_mark(Nanos calendar, pb::Status& out) const {
  const RecordingEvent* newest = nullptr;
  std::uint64_t count = 0;
  for (const RecordingEvent& each : recording_->events()) {
    if (each.calendar > calendar) break;
    if (each.event.kind() != pb::RecordedEvent::MARK) continue;
    newest = &each;
    ++count;
  }
  if (newest == nullptr) return;
  pb::MarkStatus& mark = *out.mutable_mark();
  mark.set_count(count);
  mark.set_text(shown(newest->event.text(), 200));
  mark.set_by(shown(newest->event.who()));
  mark.set_time_s(to_seconds(newest->event.at_ns()));
}

}  // namespace handrail
