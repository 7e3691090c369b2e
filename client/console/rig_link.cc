#include "client/console/rig_link.h"

#include <algorithm>
#include <utility>

#include "client/api/rig_client.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

constexpr Nanos kLookPeriod = kSecond / 60;        // as the master's status
constexpr Nanos kLookAnswer = 500 * kMillisecond;  // nothing keeps the rig's thread waiting
constexpr Nanos kPlayAnswer = 2 * kSecond;         // it reads a scene
constexpr Nanos kTryAgain = 500 * kMillisecond;    // a rig that is gone, a scene that is refused

}  // namespace

RigLink::RigLink(std::string socket, Post post, Tell tell)
    : socket_(std::move(socket)),
      post_(std::move(post)),
      tell_(std::move(tell)),
      thread_([this] { run(); }) {}

RigLink::~RigLink() {
  ending_ = true;
  thread_.join();
}

void RigLink::follow(const std::string& scene) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scene_ = scene;
}

std::string RigLink::followed() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return scene_;
}

void RigLink::run() {
  RigClient client(socket_);
  std::string refused;  // why the scene's workpiece is not there
  Nanos play_at = 0;
  for (Nanos next = monotonic_now(); !ending_;) {
    pb::RigNews news;
    const auto status = client.look(nullptr, kLookAnswer);
    const std::string wanted = followed();
    if (status && (wanted.empty() || status->scene() == wanted)) refused.clear();
    if (status && !wanted.empty() && status->scene() != wanted && monotonic_now() >= play_at) {
      const Status played = client.play(wanted, false, kPlayAnswer);
      refused = played.message();
      if (!played) play_at = monotonic_now() + kTryAgain;
    }
    if (!status) {
      news.set_problem(status.message());
    } else {
      if (status->has_scene()) news.set_scene(status->scene());
      if (status->moment_size() > 0) *news.mutable_moment() = status->moment(0);
      if (!refused.empty()) news.set_problem(refused);
    }
    post_([this, news] { tell_(news); });
    next = std::max(next + (status ? kLookPeriod : kTryAgain), monotonic_now());
    sleep_until(next);
  }
}

}  // namespace handrail
