// The order desk's work on tools: calling one as described or by its name, and what is said of it.
#include <spdlog/fmt/fmt.h>

#include <string>
#include <utility>
#include <vector>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/master/order_desk.h"
#include "server/master/replies.h"
#include "server/scene/tool_io.h"

namespace handrail {

void OrderDesk::tool(const pb::Tool& wanted, bool approach, ReplyTo reply) {
  if (wanted.has_name()) return reply(refused("name: only a scene's tool has one"));
  NamedTool tool;
  if (const auto problem = tool_call_from(wanted, tool.call)) {
    return reply(refused(problem->path + ": " + problem->text));
  }
  call_tool(std::move(tool), approach, std::move(reply));
}

void OrderDesk::named_tool(const std::string& name, bool approach, ReplyTo reply) {
  std::vector<std::string> names;
  for (const NamedTool& tool : scene_.named_tools) {
    if (tool.name == name) return call_tool(tool, approach, std::move(reply));
    names.push_back(tool.name);
  }
  reply(refused("scene '" + scene_.name + "' has no tool '" + shown(name) + "': " +
                (names.empty() ? "it names none" : "expected one of " + joined(names, ", "))));
}

void OrderDesk::call_tool(NamedTool tool, bool approach, ReplyTo reply) {
  if (approach && !is_position_tool(tool.call.kind)) {
    return reply(refused(std::string("approach: has no meaning for ") + name_of(tool.call.kind)));
  }
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
