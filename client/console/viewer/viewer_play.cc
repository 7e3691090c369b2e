// The desk's work where a recording is shown: its bar of time at the viewer.
#include <algorithm>

#include "client/console/viewer/viewer_desk.h"

namespace handrail {
namespace {

// Of the times that wait for a slow viewer the newest is enough. Its slot comes after the
// channels'.
constexpr FrameWorth kTimeFrame{static_cast<int>(ViewerDesk::Channel::kCount)};

}  // namespace

void ViewerDesk::show_recording(const ViewerRange& range, PlayOrders& orders) {
  recording_ = Recording{range, &orders, {}};
}

void ViewerDesk::greet_with_state(PageId viewer) {
  const std::string frame = playback_frame(recording_->state, recording_->now(), false, "");
  sink_.send(viewer, shared_text(frame), true, {});
}

void ViewerDesk::ask_to_play(PageId viewer, std::string_view frame) {
  const auto asked = viewer_play(frame);
  if (!asked) return say(viewer, ViewerLevel::kError, asked.message());
  PlayOrder order;
  order.playing = asked->playing;
  // A viewer offers speeds of its own: the nearest of ours is in the answer.
  order.speed = std::clamp<double>(asked->speed, kSlowestPlay, kFastestPlay);
  if (asked->seek) order.position = *asked->seek - recording_->range.begins;
  const auto state = recording_->orders->play(order);
  if (!state) return say(viewer, ViewerLevel::kError, state.message());
  tell_played(*state, viewer, asked->id);
}

bool ViewerDesk::played(const PlayState& state) {
  if (!recording_ || state.orders < recording_->state.orders) return false;
  const PlayState& was = recording_->state;
  if (state.is != was.is || state.speed != was.speed || state.jumps != was.jumps) {
    tell_played(state, 0, "");
  }
  recording_->state = state;
  if (viewers_.empty()) return true;
  const SharedText time = shared_text(time_frame(recording_->now()));
  for (const auto& [viewer, looks] : viewers_) sink_.send(viewer, time, true, kTimeFrame);
  return true;
}

// `asked_by`: who has its request's id in the answer; 0: nobody asked.
void ViewerDesk::tell_played(const PlayState& state, PageId asked_by, const std::string& id) {
  const bool jumped = state.jumps != recording_->state.jumps;
  recording_->state = state;
  for (const auto& [viewer, looks] : viewers_) {
    const std::string frame =
        playback_frame(state, recording_->now(), jumped, viewer == asked_by ? id : "");
    sink_.send(viewer, shared_text(frame), true, {});
  }
  if (!jumped) return;
  // A viewer forgets what was before; nothing happened between the two moments.
  facts_.reset();
  logged_.clear();
  for (const Channel still : {Channel::kCell, Channel::kMap}) {
    publish_still(still, recording_->now(), Whom::kAll);
  }
}

}  // namespace handrail
