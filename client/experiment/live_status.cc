#include "client/experiment/live_status.h"

#include "client/api/status_pose.h"

namespace handrail {

Vec3 vector_of(const google::protobuf::RepeatedField<double>& v) {
  return v.size() == 3 ? Vec3(v[0], v[1], v[2]) : Vec3(Vec3::Zero());
}

namespace {

Vec3 force_in(const pb::ForceShare& share) { return vector_of(share.force_n()); }

bool has_tool(const pb::ToolStatus& slot) { return slot.has_geometry(); }

// A clutch holds the arm, and a link for a moment: both belong to driving.
bool drives_in(const pb::Status& now) {
  return now.state() == "engaged" || now.state() == "clutched" || now.state() == "hold";
}

}  // namespace

Result<pb::Status> status_of(OperatorClient& client, Nanos patience) {
  pb::Request request;
  request.set_status(true);
  const Result<pb::Reply> reply = client.call(request, patience);
  if (!reply) return reply.status();
  if (!reply->done()) return Status::error("refused: " + reply->reason());
  return reply->status();
}

LiveSample sample_of(const pb::Status& now) {
  LiveSample out;
  out.X_ST = pose_of(now.tip());
  out.q_command = pose_of(now.command()).q;
  out.drives = drives_in(now) && now.has_tip();
  out.clutched = now.state() == "clutched";
  out.position_tool = has_tool(now.position_tool());
  out.orientation_tool = has_tool(now.orientation_tool());
  out.marks = now.mark().count();
  out.marked = now.mark().time_s();
  out.time = now.time_s();
  return out;
}

SubjectSight sight_of(const pb::Status& now) {
  SubjectSight out;
  out.X_ST = pose_of(now.tip());
  out.X_MH = pose_of(now.hand());
  out.f_H_M = force_in(now.device_force());
  out.drives = drives_in(now);
  out.fault = now.state() == "fault" || now.slave_state() == "fault";
  return out;
}

StartSight start_of(const pb::Status& now) {
  StartSight out;
  out.X_ST = pose_of(now.tip());
  out.drives = drives_in(now) && now.has_tip();
  out.clutched = now.state() == "clutched";
  out.tool = has_tool(now.position_tool()) || has_tool(now.orientation_tool());
  const pb::ToolStatus& place = now.position_tool();
  if (place.kind() == "point" && place.geometry().anchor_mm_size() == 3)
    out.point = kMm * vector_of(place.geometry().anchor_mm());
  const pb::ToolStatus& turn = now.orientation_tool();
  if (turn.kind() == "n-rotation" && turn.geometry().quaternion_size() == 4) {
    const auto& q = turn.geometry().quaternion();
    out.kept = Quat(q[0], q[1], q[2], q[3]);
  }
  out.turning = now.orientation_tool().turning();
  return out;
}

TraceRow row_of(const pb::Status& now, LinearPhase phase) {
  return {now.time_s(),          pose_of(now.tip()),           pose_of(now.command()),
          pose_of(now.hand()).p, force_in(now.device_force()), phase};
}

std::string holds(const pb::Status& now) {
  return now.state() == "engaged" ? now.reason() : "none";
}

}  // namespace handrail
