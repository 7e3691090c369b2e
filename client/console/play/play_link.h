// The gateway's player: what pages and viewers see of a recording, read in a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/console/gateway/play_orders.h"
#include "client/console/play/play_clock.h"
#include "client/console/scene/read_scene.h"
#include "proto/console.pb.h"
#include "proto/operator.pb.h"
#include "server/base/status.h"
#include "server/record/recorded_scenes.h"
#include "server/record/recording_reader.h"

namespace handrail {

// In place of a master: a status 60 times a second, and at once after an order. A disk that is slow
// keeps this thread alone. A moment that cannot be read is an error in place of its status, and the
// player goes on.
class PlayLink final : public PlayOrders {
 public:
  // In the thread that `post` has.
  struct Told {
    // Of one moment. `asked`: when it was looked for, by the monotonic clock.
    std::function<void(const Result<pb::Reply>&, Nanos asked, const PlayState&)> moment;
    // Another scene, or why there is nothing to draw; before the first moment of it.
    std::function<void(const std::string& name, const Result<ReadScene>&)> scene;
  };
  using Post = std::function<void(std::function<void()>)>;

  // Throws std::system_error where no thread can be had.
  PlayLink(std::unique_ptr<RecordingReader> recording, Post post, Told tell);
  ~PlayLink() override;
  PlayLink(const PlayLink&) = delete;
  PlayLink& operator=(const PlayLink&) = delete;

  Result<PlayState> play(const PlayOrder& order) override;

 private:
  void run();
  void show(const PlayState& state);
  void take_scene(std::uint32_t number);
  Result<pb::Reply> reply_of(const RecordingMoment& moment);
  void add_mark(Nanos calendar, pb::Status& out) const;

  const std::unique_ptr<RecordingReader> recording_;
  const Post post_;
  const Told tell_;
  // Of the thread alone.
  std::unique_ptr<RecordedScenes> scenes_;
  std::optional<std::uint32_t> scene_;  // the number of what is shown
  std::optional<Nanos> shown_;          // the moment that `reply_` is of
  Result<pb::Reply> reply_ = pb::Reply();

  std::mutex mutex_;  // of what follows
  std::condition_variable wake_;
  PlayClock clock_;
  bool ordered_ = false;
  bool ending_ = false;
  std::thread thread_;  // last: it uses the others
};

// What a page is told of a recording, once.
pb::RecordingNews recording_news(const RecordingReader& recording);

}  // namespace handrail
