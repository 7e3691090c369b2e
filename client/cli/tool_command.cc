#include "client/cli/tool_command.h"

#include <map>

#include "client/cli/vector_text.h"
#include "server/scene/json_io.h"
#include "server/scene/tool_io.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;
using Text = std::optional<std::string>;

constexpr Nanos kListPatience = 2 * kSecond;  // chosen, as for a status

Status put_point(const char* flag, const Text& text, Numbers* out) {
  if (!text) return Status::ok();
  const Result<Vec3> v = parse_vector(flag, *text, "mm", "350,0,429");
  if (!v) return v.status();
  out->Add(v->begin(), v->end());
  return Status::ok();
}

Status put_direction(const char* flag, const Text& text, Numbers* out) {
  if (!text) return Status::ok();
  const Result<Vec3> v = parse_direction(flag, *text);
  if (!v) return v.status();
  out->Add(v->begin(), v->end());
  return Status::ok();
}

// "end_mm[2]" -> "--end"
std::string flag_of(const std::string& path) {
  static const std::map<std::string, std::string> flags = {
      {"at_mm", "--at"},      {"direction", "--dir"},     {"normal", "--normal"},
      {"axis", "--axis"},     {"end_mm", "--end"},        {"one_way", "--one-way"},
      {"turn_deg", "--turn"}, {"tip_axis", "--tip-axis"}, {"stiffness_n_mm", "--stiffness"},
  };
  const auto found = flags.find(path.substr(0, path.find('[')));
  return found == flags.end() ? path : found->second;
}

}  // namespace

Result<pb::Tool> tool_from(pb::Tool::Kind kind, const Options& o) {
  pb::Tool tool;
  tool.set_kind(kind);
  if (Status s = put_point("--at", o.at, tool.mutable_at_mm()); !s) return s;
  if (Status s = put_point("--end", o.end, tool.mutable_end_mm()); !s) return s;
  if (Status s = put_direction("--dir", o.direction, tool.mutable_direction()); !s) return s;
  if (Status s = put_direction("--normal", o.normal, tool.mutable_normal()); !s) return s;
  if (Status s = put_direction("--axis", o.axis, tool.mutable_axis()); !s) return s;
  if (Status s = put_direction("--tip-axis", o.tip_axis, tool.mutable_tip_axis()); !s) return s;
  if (o.turn) {
    const Result<Vec3> v = parse_vector("--turn", *o.turn, "deg", "0,0,90");
    if (!v) return v.status();
    tool.mutable_turn_deg()->Add(v->begin(), v->end());
  }
  if (o.one_way) tool.set_one_way(true);
  if (o.stiffness) {
    const Result<double> k = parse_number("--stiffness", *o.stiffness, 0.0, 10.0, "N/mm");
    if (!k) return k.status();
    tool.set_stiffness_n_mm(*k);
  }
  ToolCall call;
  if (const auto problem = tool_call_from(tool, call)) {
    return Status::error(flag_of(problem->path) + ": " + problem->text);
  }
  if (o.approach && !is_position_tool(call.kind)) {
    return Status::error("--approach: has no meaning for " + pb::Tool::Kind_Name(kind));
  }
  return tool;
}

ExitCode call_tool(pb::Tool::Kind kind, const Options& options, const Console& console) {
  const Result<pb::Tool> tool = tool_from(kind, options);
  if (!tool) return complain(console, tool.message());
  pb::Request request;
  *request.mutable_tool() = *tool;
  if (options.approach) request.set_approach(true);
  return send_order(options, console, request, "tool called");
}

ExitCode run_tool_call(const Options& options, const Console& console) {
  pb::Request request;
  request.set_named_tool(*options.word);
  if (options.approach) request.set_approach(true);
  return send_order(options, console, request, "tool '" + *options.word + "' called");
}

ExitCode run_tool_list(const Options& options, const Console& console) {
  pb::Request request;
  request.set_status(true);
  const Result<pb::Reply> reply =
      OperatorClient(options.master, options.as).call(request, kListPatience);
  const ExitCode code = exit_code(reply);
  if (code != kExitDone) {
    console.err << "handrail: " << (reply ? "refused: " + reply->reason() : reply.message())
                << '\n';
    return code;
  }
  pb::Status list;
  *list.mutable_named_tool() = reply->status().named_tool();
  if (options.json) {
    console.out << json_text(list, true) << '\n';
  } else if (list.named_tool().empty()) {
    console.out << "scene '" << reply->status().scene() << "' names no tool\n";
  }
  for (const pb::NamedToolStatus& tool : list.named_tool()) {
    if (!options.json) console.out << tool.name() << "  " << tool.kind() << '\n';
  }
  return kExitDone;
}

ExitCode run_tool_off(const Options& options, const Console& console) {
  pb::Request request;
  pb::ToolOff& off = *request.mutable_tool_off();
  const std::string which = options.word.value_or("");
  if (options.word && which != "position" && which != "orientation") {
    return complain(console,
                    "tool off: '" + which + "': expected position, orientation or nothing");
  }
  off.set_position(which != "orientation");
  off.set_orientation(which != "position");
  return send_order(options, console, request, "tool off");
}

}  // namespace handrail
