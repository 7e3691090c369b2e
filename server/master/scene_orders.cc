// The order desk's work on scenes: loading one in both sides, calling its tools.
#include <algorithm>
#include <utility>

#include "server/master/order_desk.h"
#include "server/master/replies.h"

namespace handrail {

void OrderDesk::load(const std::string& name, ReplyTo reply) {
  if (!report_ || !is_idle(report_->out.link.state)) {
    return reply(refused(describe(Reason::kBusy)));
  }
  if (loading_) return reply(refused("another scene is being loaded"));
  auto scene = options_.load_scene(name);
  if (!scene) return reply(refused(scene.message()));
  previous_ = std::exchange(scene_, std::move(*scene));
  boxes_.settings.publish(options_.settings_of(scene_));
  loading_ = std::move(reply);
  load_epoch_ = report_->scene_epoch;
  load_shown_ = kForever;
  load_until_ = now_ + kScenePatience;
}

void OrderDesk::watch_scene() {
  if (!loading_ || report_->settings_pending || report_->scene_epoch == load_epoch_) return;
  if (text_of(report_->out.link.scene) != scene_.name) return;
  load_shown_ = std::min(load_shown_, now_);
  if (report_->walls.present) return std::exchange(loading_, nullptr)(done());
  if (link_.age(now_) > kHeard) {
    std::exchange(loading_, nullptr)(done("no slave is connected: it loads the scene when it is"));
    return;
  }
  const auto differences = hash_mismatches(report_->out.link, slave_);
  const bool missing = slave_.reason == Reason::kSceneNotLoaded;
  // Until the slave has seen the scene, what it cannot load is one before.
  const bool seen = link_.echoed_sent >= load_shown_;
  if (differences.empty()) {
    std::exchange(loading_, nullptr)(done());
  } else if (now_ > load_until_ || (missing && seen)) {
    end_scene_wait(missing ? describe(slave_.reason) : differences.front());
  }
}

void OrderDesk::end_scene_wait(const std::string& problem) {
  const std::string name = scene_.name;
  scene_ = std::move(*previous_);
  boxes_.settings.publish(options_.settings_of(scene_));
  std::exchange(loading_, nullptr)(refused("the slave did not load '" + name + "': " + problem +
                                           "; '" + scene_.name + "' stays"));
}

// A scene's own tools are called at each engagement, also one that begins with the clutch held. As
// an operator's they must be near; none is approached.
void OrderDesk::call_scene_tools() {
  const SessionState state = report_->out.link.state;
  const bool engaged = !is_idle(state) && state != SessionState::kAligning;
  if (engaged && !was_engaged_) {
    tools_refused_.clear();
    for (const ToolCall& call : scene_.tools) {
      HapticOrder wanted = plain(OrderKind::kTool);
      wanted.tool = call;
      ++scene_tools_;
      order(wanted, [this](const pb::Reply& reply) {
        --scene_tools_;
        if (reply.done()) return;
        tools_refused_ +=
            (tools_refused_.empty() ? "the scene's tool was refused: " : "; ") + reply.reason();
      });
    }
  }
  was_engaged_ = engaged;
}

}  // namespace handrail
