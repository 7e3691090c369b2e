// The order desk's work on scenes: loading one in both sides, its stages, calling its tools
// and those that an operator describes.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/master/order_desk.h"
#include "server/master/replies.h"
#include "server/scene/tool_io.h"

namespace handrail {

void OrderDesk::load(const std::string& name, const std::string& who, ReplyTo reply) {
  if (!scene_may_change()) return reply(refused(describe(Reason::kBusy)));
  if (reading_) return reply(refused("scene '" + shown(reading_->scene) + "' is still being read"));
  if (waits(Until::kScene, Place::kTaken)) {
    return reply(refused("another scene is being loaded"));
  }
  Pending order{std::move(reply), Until::kScene, now_, {}, false, Place::kHere};
  order.deadline = now_ + kReadPatience;
  pending_.push_back(std::move(order));
  reading_ = {name, who};
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
    const auto late = [this](const Pending& p) {
      return p.until == Until::kScene && p.place == Place::kHere && now_ > p.deadline;
    };
    if (std::any_of(pending_.begin(), pending_.end(), late)) {
      refuse_all(Until::kScene, Place::kHere,
                 "scene '" + shown(reading_->scene) +
                     "' is not loaded: the disk has not given it for " +
                     fmt::format("{:g} s", to_seconds(kReadPatience)));
    }
    return;
  }
  const Reading read = *std::exchange(reading_, std::nullopt);
  auto order = take(Until::kScene, Place::kHere);
  if (!order) return;
  const ReplyTo& reply = order->reply;
  if (!*scene) return reply(refused(scene->message()));
  if (!leases_.may_drive(read.who)) {
    return reply(
        refused("somebody else drives by now: scene '" + shown(read.scene) + "' is not loaded"));
  }
  if (!scene_may_change()) return reply(refused(describe(Reason::kBusy)));
  const LoopScene next = options_.loop_scene(**scene);  // the last that can fail
  previous_ = std::exchange(scene_, std::move(**scene));
  boxes_.scene.publish(next);
  order->place = Place::kTaken;
  order->deadline = now_ + kScenePatience;
  pending_.push_back(std::move(*order));
  load_epoch_ = report_->scene_epoch;
  load_shown_ = kForever;
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
  reply(refused(known.empty() ? scene + "stages"
                              : scene + "stage '" + shown(name) + "', expected one of " + known));
}

void OrderDesk::screw(double c, ReplyTo reply) {
  constexpr double kMost = 100.0;  // beyond the dissertation's 15, our choice [N s/(m rad)]
  const auto turns = [](const EffectSpec& e) { return e.kind == EffectKind::kProgressive; };
  if (std::none_of(scene_.effects.begin(), scene_.effects.end(), turns)) {
    return reply(
        refused("scene '" + scene_.name + "' has no screw: it lists no progressive effect"));
  }
  if (!(c >= 0.0 && c <= kMost)) {
    return reply(
        refused(fmt::format("screw: c of {:g}, expected 0 to {:g} N s/(m rad)", c, kMost)));
  }
  HapticOrder wanted = plain(OrderKind::kScrew);
  wanted.screw_c = c;
  order(wanted, std::move(reply));
}

void OrderDesk::show_scene(pb::Status& status) const {
  if (status.scene() != scene_.name) return;
  status.set_scene_file(scene_.file);
  if (!status.has_walls()) {
    if (scene_.X_AT) status.set_mounted(true);
    return show_joints(arm_of(scene_), slave_, status);
  }
  if (!scene_.walls) return;
  // The loop counts stages; their names are the scene's.
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

std::optional<pb::Reply> OrderDesk::check_scene(const Pending& order) {
  if (report_->scene_pending || report_->scene_epoch == load_epoch_) return std::nullopt;
  if (text_of(report_->out.link.scene) != scene_.name) return std::nullopt;
  load_shown_ = std::min(load_shown_, now_);
  if (report_->walls.present) return done();
  if (link_.age(now_) > kHeardLately) {
    return done("no slave is connected: it loads the scene when it is");
  }
  const auto differences = hash_mismatches(report_->out.link, slave_);
  if (differences.empty()) return done();
  const bool missing = slave_.reason == Reason::kSceneNotLoaded;
  // Until the slave has seen the scene, what it cannot load is one before.
  const bool seen = link_.echoed_sent >= load_shown_;
  if (now_ <= order.deadline && !(missing && seen)) return std::nullopt;
  return take_scene_back(missing ? describe(slave_.reason) : differences.front());
}

pb::Reply OrderDesk::take_scene_back(const std::string& problem) {
  const std::string name = scene_.name;
  const LoopScene next = options_.loop_scene(*previous_);  // the last that can fail
  scene_ = std::move(*previous_);
  boxes_.scene.publish(next);
  return refused("the slave did not load '" + name + "': " + problem + "; '" + scene_.name +
                 "' stays");
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

void OrderDesk::tool(const pb::Tool& wanted, bool approach, ReplyTo reply) {
  if (wanted.has_name()) return reply(refused("name: only a scene's tool has one"));
  NamedTool tool;
  if (const auto problem = tool_call_from(wanted, tool.call)) {
    return reply(refused(problem->path + ": " + problem->text));
  }
  if (approach && !is_position_tool(tool.call.kind)) {
    return reply(refused("approach: has no meaning for " + pb::Tool::Kind_Name(wanted.kind())));
  }
  call_tool(std::move(tool), approach, std::move(reply));
}

void OrderDesk::named_tool(const std::string& name, bool approach, ReplyTo reply) {
  std::vector<std::string> names;
  for (const NamedTool& tool : scene_.named_tools) {
    names.push_back(tool.name);
    if (tool.name != name) continue;
    if (approach && !is_position_tool(tool.call.kind)) {
      return reply(refused("approach: has no meaning for '" + name + "', a tool of the kind " +
                           name_of(tool.call.kind)));
    }
    return call_tool(tool, approach, std::move(reply));
  }
  reply(refused("scene '" + scene_.name + "' has no tool '" + shown(name) + "': " +
                (names.empty() ? "it names none" : "expected one of " + joined(names, ", "))));
}

void OrderDesk::call_tool(NamedTool tool, bool approach, ReplyTo reply) {
  OrderTicket ticket;
  ticket.order = plain(OrderKind::kTool);
  ticket.order.tool = tool.call;
  ticket.order.tool.approach = approach;
  Pending order{std::move(reply), Until::kTaken, now_, ticket.order.tool};
  order.name = std::move(tool.name);
  push(ticket, std::move(order));
}

void OrderDesk::show_named_tools(pb::Status& status) const {
  for (const NamedTool& tool : scene_.named_tools) {
    pb::NamedToolStatus& out = *status.add_named_tool();
    out.set_name(tool.name);
    out.set_kind(name_of(tool.call.kind));
  }
  for (pb::ToolStatus* slot : {status.mutable_position_tool(), status.mutable_orientation_tool()}) {
    for (const CalledByName& called : called_by_name_) {
      if (called.id != 0 && called.id == slot->id()) slot->set_name(called.name);
    }
  }
}

std::string OrderDesk::distance_text(const OrderAnswer& answer, const ToolCall& call) const {
  const Scene::Guidance& guidance = scene_.guidance;
  if (answer.result == Reason::kToolFar) {
    return fmt::format(
        "the {} is {:.1f} mm from the tip, or from where the hand sends it, at most {:g} mm; "
        "--approach goes there",
        name_of(call.kind), answer.tool_distance / kMm, guidance.tool_reach / kMm);
  }
  if (answer.result == Reason::kHandElsewhere) {
    return fmt::format(
        "absolute mapping: the hand asks for a tip {:.1f} mm and {:.1f} deg from where it is, at "
        "most {:g} mm and {:g} deg: lead the hand there",
        answer.tool_distance / kMm, answer.tool_angle / kDeg, kAgree / kMm, kAgreeTurned / kDeg);
  }
  if (answer.result != Reason::kNone) return {};
  if (answer.tool_angle > 0.0) {
    const bool clutched = report_ && report_->out.link.state == SessionState::kClutched;
    return fmt::format("{:.1f} deg to go{}, about {:.1f} s; the clutch ends it",
                       answer.tool_angle / kDeg, clutched ? " once the clutch is let go" : "",
                       answer.tool_angle / guidance.catch_up_rotation);
  }
  if (!call.approach) {
    if (answer.hand_latched == 0.0) return {};
    return fmt::format("the hand was {:.1f} mm off and leads on from where it is",
                       answer.hand_latched / kMm);
  }
  return fmt::format("{:.1f} mm to go, about {:.1f} s; the clutch ends it",
                     answer.tool_distance / kMm, answer.tool_distance / guidance.catch_up);
}

}  // namespace handrail
