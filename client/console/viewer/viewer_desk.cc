#include "client/console/viewer/viewer_desk.h"

#include <algorithm>
#include <utility>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr std::uint16_t kPolicy = 1008;  // RFC 6455: a frame that is not to be

struct ChannelRow {
  ViewerDesk::Channel channel;
  const char* topic;
  const google::protobuf::Descriptor* type;
};

using Channel = ViewerDesk::Channel;

// A viewer knows a channel by its place here, from 1 on.
const std::vector<ChannelRow>& channel_rows() {
  static const std::vector<ChannelRow> rows = {
      {Channel::kFrames, "/tf", foxglove::FrameTransforms::descriptor()},
      {Channel::kJointStates, "/joints", foxglove::JointStates::descriptor()},
      {Channel::kTip, "/tip", foxglove::PoseInFrame::descriptor()},
      {Channel::kDesired, "/tip/desired", foxglove::PoseInFrame::descriptor()},
      {Channel::kCell, "/cell", foxglove::SceneUpdate::descriptor()},
      {Channel::kMarks, "/marks", foxglove::SceneUpdate::descriptor()},
      {Channel::kMap, "/map", foxglove::Grid::descriptor()},
      {Channel::kLog, "/log", foxglove::Log::descriptor()},
      {Channel::kEvents, "/events", pb::ViewerEvent::descriptor()},
      {Channel::kStatus, "/status", pb::Status::descriptor()}};
  return rows;
}

std::size_t index_of(Channel channel) { return static_cast<std::size_t>(channel); }

std::string channels_text() {
  pb::ViewerAdvertise out;
  out.set_op("advertise");
  for (const ChannelRow& row : channel_rows()) {
    const auto id = static_cast<std::uint32_t>(index_of(row.channel) + 1);
    *out.add_channels() = viewer_channel(id, row.topic, *row.type);
  }
  return advertise_text(out);
}

// Of the newest alone, but for what is said once.
FrameWorth worth_of(Channel channel) {
  const bool said_once = channel == Channel::kLog || channel == Channel::kEvents;
  return {static_cast<int>(index_of(channel)), said_once ? ViewerDesk::kMostWait : 1};
}

}  // namespace

ViewerDesk::ViewerDesk(PageSink& viewers, const std::string& version, const std::string& session)
    : sink_(viewers), version_(version), session_(session), channels_(channels_text()) {}

void ViewerDesk::opened(PageId viewer, Nanos now) {
  viewers_[viewer].second = now;
  const auto range = recording_ ? std::optional(recording_->range) : std::nullopt;
  sink_.send(viewer, shared_text(server_info_text(version_, session_, range)), false, {});
  sink_.send(viewer, shared_text(channels_), false, {});
  if (recording_) greet_with_state(viewer);
}

void ViewerDesk::say(PageId viewer, ViewerLevel level, const std::string& message) {
  sink_.send(viewer, shared_text(status_text(level, message)), false, {});
}

void ViewerDesk::received(PageId viewer, std::string_view frame, bool binary, const Moment& at) {
  const auto from = viewers_.find(viewer);
  if (from == viewers_.end()) return;
  Viewer& of = from->second;
  if (at.now - of.second >= kSecond) {
    of.second = at.now;
    of.frames = 0;
  }
  if (++of.frames > kMostFrames) {
    return sink_.end(viewer, kPolicy,
                     "more than " + std::to_string(kMostFrames) + " frames in a second");
  }
  constexpr char kOnlyLooks[] = "a viewer only looks here: expected subscribe or unsubscribe";
  if (binary && recording_) return ask_to_play(viewer, frame);
  if (binary) return say(viewer, ViewerLevel::kError, kOnlyLooks);
  const auto said = viewer_frame(frame);
  if (!said) return say(viewer, ViewerLevel::kError, said.message());
  if (said->op() == "subscribe") {
    for (const auto& asked : said->subscriptions()) subscribe(viewer, asked, stamp(at.calendar));
  } else if (said->op() == "unsubscribe") {
    for (const std::uint32_t id : said->subscription_ids()) unsubscribe(viewer, id);
  } else {
    say(viewer, ViewerLevel::kError, "op '" + shown(said->op()) + "': " + kOnlyLooks);
  }
}

void ViewerDesk::subscribe(PageId viewer, const pb::FromViewer::Subscription& asked,
                           Nanos calendar) {
  auto& looks = viewers_[viewer].looks;
  const auto refuse = [&](const std::string& why) {
    say(viewer, ViewerLevel::kError, "subscription " + std::to_string(asked.id()) + why);
  };
  if (!asked.has_id() || !asked.has_channel_id()) return refuse(": expected id and channelId");
  const std::size_t index = std::size_t{asked.channel_id()} - 1;
  if (index >= kChannels) {
    return refuse(": there is no channel " + std::to_string(asked.channel_id()));
  }
  const bool used = std::any_of(looks.begin(), looks.end(),
                                [&](const auto& look) { return look && look->id == asked.id(); });
  if (used) return refuse(": this id is used already");
  if (looks[index]) {
    return refuse(": channel " + std::to_string(asked.channel_id()) + " is subscribed already");
  }
  looks[index] = Look{asked.id()};
  const auto channel = static_cast<Channel>(index);
  publish_still(channel, calendar, Whom::kFresh);
}

void ViewerDesk::unsubscribe(PageId viewer, std::uint32_t id) {
  for (auto& look : viewers_[viewer].looks) {
    if (!look || look->id != id) continue;
    look.reset();
    return;
  }
  say(viewer, ViewerLevel::kWarning, "subscription " + std::to_string(id) + " is not known");
}

bool ViewerDesk::is_watched(Channel channel) const {
  return std::any_of(viewers_.begin(), viewers_.end(), [&](const auto& viewer) {
    return viewer.second.looks[index_of(channel)].has_value();
  });
}

template <typename Make>
void ViewerDesk::publish(Channel channel, Nanos calendar, Whom whom, const Make& make) {
  std::optional<std::string> message;
  std::uint32_t last = 0;  // subscription that `frame` is for
  SharedText frame;
  for (auto& [viewer, state] : viewers_) {
    auto& look = state.looks[index_of(channel)];
    if (!look || (whom == Whom::kFresh && !look->fresh)) continue;
    look->fresh = false;
    if (!message) {
      message = make().SerializeAsString();
      ++encoded_;
    }
    if (!frame || last != look->id) frame = shared_text(data_frame(look->id, calendar, *message));
    last = look->id;
    sink_.send(viewer, frame, true, worth_of(channel));
  }
}

// What is the same until there is another scene.
void ViewerDesk::publish_still(Channel channel, Nanos calendar, Whom whom) {
  if (channel == Channel::kCell) {
    publish(channel, calendar, whom, [&] { return work_cell(scene_, calendar); });
  }
  if (channel == Channel::kMap) {
    publish(channel, calendar, whom, [&] { return map_grid(cells_, calendar); });
  }
}

void ViewerDesk::scene(const pb::SceneNews& news, MapCells cells, Nanos calendar) {
  scene_ = news;
  cells_ = std::move(cells);
  calendar = stamp(calendar);
  publish(Channel::kMarks, calendar, Whom::kAll, [&] { return nothing_drawn(calendar); });
  for (const Channel still : {Channel::kCell, Channel::kMap}) {
    publish_still(still, calendar, Whom::kAll);
  }
}

void ViewerDesk::status(const Result<pb::Reply>& reply, Nanos calendar) {
  if (viewers_.empty()) {
    facts_.reset();
    return;
  }
  calendar = stamp(calendar);
  publish_log(reply, calendar);
  publish_events(reply, calendar);
  if (reply && reply->has_status()) publish_status(reply->status(), calendar);
}

void ViewerDesk::publish_status(const pb::Status& status, Nanos calendar) {
  publish(Channel::kFrames, calendar, Whom::kAll,
          [&] { return frame_transforms(status, scene_, calendar); });
  publish(Channel::kJointStates, calendar, Whom::kAll,
          [&] { return joint_states(status, calendar); });
  if (status.has_tip()) {
    publish(Channel::kTip, calendar, Whom::kAll,
            [&] { return pose_in_frame(status.tip(), calendar); });
  }
  if (status.has_desired_tip()) {
    publish(Channel::kDesired, calendar, Whom::kAll,
            [&] { return pose_in_frame(status.desired_tip(), calendar); });
  }
  publish(Channel::kMarks, calendar, Whom::kAll, [&] { return marks(status, scene_, calendar); });
  publish(Channel::kStatus, calendar, Whom::kAll, [&]() -> const pb::Status& { return status; });
}

void ViewerDesk::publish_log(const Result<pb::Reply>& reply, Nanos calendar) {
  if (!is_watched(Channel::kLog)) return;
  const foxglove::Log line = log_line(reply, calendar);
  const bool changed = std::exchange(logged_, line.message()) != line.message();
  publish(Channel::kLog, calendar, changed ? Whom::kAll : Whom::kFresh,
          [&]() -> const foxglove::Log& { return line; });
}

void ViewerDesk::publish_events(const Result<pb::Reply>& reply, Nanos calendar) {
  if (!is_watched(Channel::kEvents)) {
    facts_.reset();
    return;
  }
  const ViewerFacts is = facts_of(reply);
  if (facts_) {
    for (const pb::ViewerEvent& event : events_between(*facts_, is, calendar)) {
      publish(Channel::kEvents, calendar, Whom::kAll,
              [&]() -> const pb::ViewerEvent& { return event; });
    }
  }
  facts_ = is;
}

}  // namespace handrail
