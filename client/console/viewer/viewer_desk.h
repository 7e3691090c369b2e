// Foxglove and Lichtblick at the console: who looks at which channel, and what goes there.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "client/console/gateway/play_orders.h"
#include "client/console/gateway/web.h"
#include "client/console/viewer/viewer_picture.h"
#include "client/console/viewer/viewer_protocol.h"
#include "proto/console.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// When something came: for decisions, and for people.
struct Moment {
  Nanos now = 0;       // monotonic
  Nanos calendar = 0;  // since 1970-01-01 UTC
};

// A viewer looks and does nothing else: the desk has no way to the master. Of a recording it may
// play, pause and seek, for all who look. A message is encoded
// where somebody is subscribed to its channel, once for all of them. Of data that waits for a slow
// viewer the oldest is left out. Sans IO.
class ViewerDesk {
 public:
  static constexpr std::size_t kMostViewers = 16;
  static constexpr int kMostFrames = 100;       // from a viewer in a second
  static constexpr std::size_t kMostWait = 64;  // lines of /log, and events, for a slow viewer

  enum class Channel : std::uint8_t {
    kFrames,
    kJointStates,
    kTip,
    kDesired,
    kCell,
    kMarks,
    kMap,
    kLog,
    kEvents,
    kStatus,
    kCount
  };

  // `viewers` must outlive the desk. `session`: another one each time the gateway starts.
  ViewerDesk(PageSink& viewers, const std::string& version, const std::string& session);
  // Before the first comes: it is a recording that is shown, and all times are of its calendar.
  // `orders` must outlive the desk.
  void show_recording(const ViewerRange& range, PlayOrders& orders);

  void opened(PageId viewer, Nanos now);
  void received(PageId viewer, std::string_view frame, bool binary, const Moment& at);
  void closed(PageId viewer) { viewers_.erase(viewer); }
  bool has(PageId viewer) const { return viewers_.contains(viewer); }
  std::size_t viewers() const noexcept { return viewers_.size(); }

  // What the newest question to the master brought.
  void status(const Result<pb::Reply>& reply, Nanos calendar);
  // Of a recording, before the status of that moment. False: it is older than an order, and that
  // status is not to be shown any more.
  bool played(const PlayState& state);
  // As the pages have it, and its map where it has walls.
  void scene(const pb::SceneNews& news, MapCells cells, Nanos calendar);

  // How often a message was encoded, of all channels.
  std::uint64_t encoded() const noexcept { return encoded_; }

 private:
  static constexpr std::size_t kChannels = static_cast<std::size_t>(Channel::kCount);
  struct Look {
    std::uint32_t id;   // the viewer's own
    bool fresh = true;  // has had nothing yet
  };
  struct Viewer {
    std::array<std::optional<Look>, kChannels> looks = {};
    int frames = 0;    // in this second
    Nanos second = 0;  // when that began
  };
  enum class Whom : std::uint8_t { kAll, kFresh };

  struct Recording {
    ViewerRange range;
    PlayOrders* orders = nullptr;
    PlayState state;
    Nanos now() const { return range.begins + state.position; }
  };
  void greet_with_state(PageId viewer);
  void ask_to_play(PageId viewer, std::string_view frame);
  void tell_played(const PlayState& state, PageId asked_by, const std::string& id);
  // The time that is to stand at a message.
  Nanos stamp(Nanos calendar) const { return recording_ ? recording_->now() : calendar; }
  void subscribe(PageId viewer, const pb::FromViewer::Subscription& asked, Nanos calendar);
  void unsubscribe(PageId viewer, std::uint32_t id);
  void say(PageId viewer, ViewerLevel level, const std::string& message);
  bool is_watched(Channel channel) const;
  template <typename Make>
  void publish(Channel channel, Nanos calendar, Whom whom, const Make& make);
  void publish_still(Channel channel, Nanos calendar, Whom whom);
  void publish_status(const pb::Status& status, Nanos calendar);
  void publish_log(const Result<pb::Reply>& reply, Nanos calendar);
  void publish_events(const Result<pb::Reply>& reply, Nanos calendar);

  PageSink& sink_;
  const std::string version_, session_, channels_;
  std::optional<Recording> recording_;
  std::map<PageId, Viewer> viewers_;
  pb::SceneNews scene_;
  MapCells cells_;
  std::string logged_;                // the newest line
  std::optional<ViewerFacts> facts_;  // that events were told of; none while nobody looks
  std::uint64_t encoded_ = 0;
};

}  // namespace handrail
