// Lines and events: what changes now and then.
#include "client/console/viewer/message_parts.h"
#include "client/console/viewer/viewer_picture.h"
#include "server/model/reason.h"

namespace handrail {
namespace {

const char kNone[] = "none";

bool is_fault(const std::string& state) { return state == "fault"; }

bool is_held(const std::string& reason) {
  return !reason.empty() && reason != kNone && reason != describe(Reason::kNotEngaged);
}

// "engaged", "hold: the link is stale".
std::string state_text(const std::string& state, const std::string& reason) {
  return reason.empty() || reason == kNone ? state : state + ": " + reason;
}

pb::ViewerEvent event(pb::ViewerEvent::Kind kind, const std::string& text, const std::string& value,
                      Nanos calendar) {
  pb::ViewerEvent out;
  *out.mutable_timestamp() = timestamp_of(calendar);
  out.set_kind(kind);
  out.set_text(text);
  out.set_value(value);
  return out;
}

pb::ViewerEvent state_event(const ViewerFacts& is, Nanos calendar) {
  if (!is_fault(is.state)) {
    return event(pb::ViewerEvent::STATE, "the session is " + state_text(is.state, is.reason),
                 is.state, calendar);
  }
  const bool stop = is.reason == describe(Reason::kStopRequested);
  return event(stop ? pb::ViewerEvent::STOP : pb::ViewerEvent::FAULT, is.reason, is.reason,
               calendar);
}

}  // namespace

foxglove::Log log_line(const Result<pb::Reply>& reply, Nanos calendar) {
  foxglove::Log out;
  *out.mutable_timestamp() = timestamp_of(calendar);
  out.set_name("handrail");
  if (!reply || !reply->has_status()) {
    out.set_level(foxglove::Log::ERROR);
    out.set_message(reply ? reply->reason() : reply.message());
    return out;
  }
  const pb::Status& s = reply->status();
  std::string text = state_text(s.state(), s.reason());
  if (!s.slave_state().empty()) text += "; arm " + state_text(s.slave_state(), s.slave_reason());
  const bool held = is_held(s.reason()) || is_held(s.slave_reason());
  out.set_level(is_fault(s.state()) || is_fault(s.slave_state()) ? foxglove::Log::ERROR
                : held                                           ? foxglove::Log::WARNING
                                                                 : foxglove::Log::INFO);
  out.set_message(text);
  return out;
}

ViewerFacts facts_of(const Result<pb::Reply>& reply) {
  ViewerFacts out;
  out.answers = reply && reply->has_status();
  if (!out.answers) return out;
  const pb::Status& s = reply->status();
  out.state = s.state();
  out.reason = s.reason();
  out.holder = s.lease().holder();
  out.scene = s.scene();
  if (!s.walls().stage_name().empty()) out.scene += ", stage " + s.walls().stage_name();
  return out;
}

std::vector<pb::ViewerEvent> events_between(const ViewerFacts& was, const ViewerFacts& is,
                                            Nanos calendar) {
  std::vector<pb::ViewerEvent> out;
  if (was.answers != is.answers) {
    const char* text = is.answers ? "the master answers" : "the master does not answer";
    out.push_back(event(pb::ViewerEvent::MASTER, text, is.answers ? "here" : "gone", calendar));
  }
  if (!is.answers) return out;
  const bool other_fault = is_fault(is.state) && was.reason != is.reason;
  if (was.state != is.state || other_fault) out.push_back(state_event(is, calendar));
  if (was.holder != is.holder) {
    out.push_back(event(pb::ViewerEvent::LEASE,
                        is.holder.empty() ? "nobody has the lease" : is.holder + " has the lease",
                        is.holder, calendar));
  }
  if (was.scene != is.scene) {
    out.push_back(event(pb::ViewerEvent::SCENE, "the scene is " + is.scene, is.scene, calendar));
  }
  return out;
}

}  // namespace handrail
