// The order desk's work on scenes: loading one in both sides, its stages, calling its tools.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "server/master/order_desk.h"
#include "server/master/replies.h"

namespace handrail {

void OrderDesk::load(const std::string& name, const std::string& who, ReplyTo reply) {
  if (!scene_may_change()) return reply(refused(describe(Reason::kBusy)));
  if (reading_) return reply(refused("scene '" + reading_->scene + "' is still being read"));
  if (loading_) return reply(refused("another scene is being loaded"));
  loading_ = std::move(reply);
  reading_ = {name, who, now_ + kReadPatience};
  take_scene();
}

bool OrderDesk::scene_may_change() const {
  return report_ && is_idle(report_->out.link.state) && !engage_waits();
}

// What the disk has given; the rest of the time everything else is served. What was refused
// meanwhile, or may not be done any more, is not done late.
void OrderDesk::take_scene() {
  if (!reading_) return;
  auto scene = options_.load_scene(reading_->scene);
  if (!scene) {
    if (!loading_ || now_ <= reading_->until) return;
    return std::exchange(loading_, nullptr)(
        refused("scene '" + reading_->scene + "' is not loaded: the disk has not given it for " +
                fmt::format("{:g} s", to_seconds(kReadPatience))));
  }
  const Reading read = *std::exchange(reading_, std::nullopt);
  ReplyTo reply = std::exchange(loading_, nullptr);
  if (!reply) return;
  if (!*scene) return reply(refused(scene->message()));
  if (!leases_.may_drive(read.who)) {
    return reply(refused("somebody else drives by now: scene '" + read.scene + "' is not loaded"));
  }
  if (!scene_may_change()) return reply(refused(describe(Reason::kBusy)));
  const LoopScene next = options_.loop_scene(**scene);  // the last that can fail
  previous_ = std::exchange(scene_, std::move(**scene));
  boxes_.scene.publish(next);
  loading_ = std::move(reply);
  load_epoch_ = report_->scene_epoch;
  load_shown_ = kForever;
  load_until_ = now_ + kScenePatience;
}

void OrderDesk::stage(const std::string& name, ReplyTo reply) {
  std::string known;
  for (std::size_t i = 0; scene_.walls && i < scene_.walls->stages.size(); ++i) {
    const std::string& other = scene_.walls->stages[i].name;
    if (other.empty()) continue;
    if (other == name) {
      HapticOrder wanted = plain(OrderKind::kStage);
      wanted.stage = static_cast<int>(i);
      return order(wanted, std::move(reply));
    }
    known += (known.empty() ? "'" : ", '") + other + "'";
  }
  const std::string scene = "scene '" + scene_.name + "' has no ";
  reply(refused(known.empty()
                    ? scene + "stages"
                    : scene + "stage '" + name.substr(0, 60) + "', expected one of " + known));
}

// The loop counts stages; their names are the scene's.
void OrderDesk::name_stage(pb::Status& status) const {
  if (!status.has_walls() || !scene_.walls || status.scene() != scene_.name) return;
  const std::vector<WallStage>& stages = scene_.walls->stages;
  const std::uint32_t i = status.walls().stage();
  if (i < stages.size() && !stages[i].name.empty()) {
    status.mutable_walls()->set_stage_name(stages[i].name);
  }
  const std::vector<WallRegion>& regions = scene_.walls->regions;
  const std::uint32_t region = status.walls().region();
  if (region < regions.size()) status.mutable_walls()->set_region_name(regions[region].name);
  if (!report_ || !report_->walls.locked) return;
  for (const EffectSpec& effect : scene_.effects) {
    const auto place = static_cast<std::size_t>(report_->walls.place);
    if (effect.kind != EffectKind::kDetent || place >= effect.place_names.size()) continue;
    status.mutable_walls()->set_place(effect.place_names[place]);
  }
}

void OrderDesk::watch_scene() {
  if (!loading_ || reading_ || report_->scene_pending || report_->scene_epoch == load_epoch_)
    return;
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
  const LoopScene next = options_.loop_scene(*previous_);  // the last that can fail
  scene_ = std::move(*previous_);
  boxes_.scene.publish(next);
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
