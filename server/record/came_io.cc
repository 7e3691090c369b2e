#include "server/record/came_io.h"

#include <cmath>
#include <string>

#include "server/link/check.h"
#include "server/link/codec_fields.h"
#include "server/record/tick_io.h"

namespace handrail {
namespace {

using CameNumbers = google::protobuf::RepeatedField<double>;

constexpr int kForceNumbers = 8 * 3, kMotionNumbers = 3 * MotionLedger::kStages, kSpeaks = 3;

Status no_value(const char* field, const std::string& what) {
  return Status::error(std::string(field) + " " + what);
}

Status check_numbers(const char* field, const CameNumbers& values, int expected) {
  if (values.size() != expected) {
    return no_value(field, "has " + std::to_string(values.size()) + " numbers, expected " +
                               std::to_string(expected));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) return no_value(field, "has a number that is none");
  }
  return Status::ok();
}

Status take_code(const char* field, std::uint32_t code, Reason& out) {
  if (code >= static_cast<std::uint32_t>(Reason::kCount)) {
    return no_value(field, "is " + std::to_string(code) + ", which is none");
  }
  out = static_cast<Reason>(code);
  return Status::ok();
}

Vec3 vec3_at(const CameNumbers& values, int i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

Status take_reasons(const pb::RecordedTick& in, HapticOutput& out) {
  struct Row {
    const char* field;
    std::uint32_t code;
    Reason& to;
  };
  for (const Row& row :
       {Row{"order_result", in.order_result(), out.order_result},
        Row{"reason", in.reason(), out.reason}, Row{"obstacle", in.obstacle(), out.obstacle},
        Row{"peer_fault", in.peer_fault(), out.peer_fault}}) {
    if (Status taken = take_code(row.field, row.code, row.to); !taken) return taken;
  }
  for (const std::uint32_t code : in.reasons()) {
    Reason reason = Reason::kNone;
    if (Status taken = take_code("reasons", code, reason); !taken) return taken;
    out.reasons.add(reason);
  }
  return Status::ok();
}

Status take_forces(const pb::RecordedTick& in, HapticOutput& out) {
  if (Status sound = check_numbers("wrench", in.wrench(), 6); !sound) return sound;
  if (Status sound = check_numbers("force", in.force(), kForceNumbers); !sound) return sound;
  out.f_H_M = {vec3_at(in.wrench(), 0), vec3_at(in.wrench(), 1)};
  ForceLedger& f = out.force;
  int i = 0;
  for (Vec3* v :
       {&f.tool, &f.walls, &f.spring, &f.governor, &f.limits, &f.clamp, &f.cue, &f.device}) {
    *v = vec3_at(in.force(), i++);
  }
  out.shares.tool = f.tool + f.walls + f.clamp;
  out.shares.spring = f.spring;
  out.shares.limited = f.governor + f.limits + f.cue;
  out.shares.device = f.device;
  out.shares.peak_took = f.clamp;
  out.energy_made = in.energy_made();
  return Status::ok();
}

// `slave` is that of the tick. The hand leads the arm where the step has said where it would be.
Status take_motion(const pb::RecordedTick& in, const HapticInput& given, HapticOutput& out) {
  if (Status sound = check_numbers("motion", in.motion(), kMotionNumbers); !sound) return sound;
  if (in.motion_why_size() != MotionLedger::kStages) {
    return no_value("motion_why", "has " + std::to_string(in.motion_why_size()) +
                                      " codes, expected " + std::to_string(MotionLedger::kStages));
  }
  if (in.joint() < -1 || in.joint() >= kJoints) {
    return no_value("joint", "is " + std::to_string(in.joint()) + ", expected -1 to 5");
  }
  MotionLedger& motion = out.motion;
  for (int i = 0; i < MotionLedger::kStages; ++i) {
    motion.off_S.col(i) = vec3_at(in.motion(), i);
    if (Status taken =
            take_code("motion_why", in.motion_why(i), motion.why[static_cast<std::size_t>(i)]);
        !taken) {
      return taken;
    }
  }
  motion.joint = static_cast<std::int8_t>(in.joint());
  // A hand that does not lead leaves the offsets of when it did.
  const bool leads =
      (out.link.state == SessionState::kEngaged && out.reason != Reason::kDeviceInvalid) ||
      out.link.state == SessionState::kHold;
  motion.known = leads && given.slave_known && given.slave.has_pose;
  motion.q_SH = motion.q_SP = motion.q_SU = out.link.X_SU.q;
  motion.q_ST = given.slave.X_ST_command.q;
  return Status::ok();
}

Status take_walls(const pb::RecordedWalls& in, WallOutput& out) {
  for (const Status& sound :
       {check_numbers("walls.hand", in.hand(), 2), check_numbers("walls.proxy", in.proxy(), 2),
        check_numbers("walls.normal", in.normal(), 2),
        check_numbers("walls.effects", in.effects(), 2)}) {
    if (!sound) return sound;
  }
  // As many regions as a scene can have.
  constexpr std::uint32_t kMostRegions = 64;
  if (in.region() >= kMostRegions || in.wall() >= kMostRegions) {
    return no_value("walls.region", "or wall is over 63");
  }
  if (!std::isfinite(in.turned())) return no_value("walls.turned", "is no number");
  const auto vec2 = [](const CameNumbers& values) { return Vec2(values[0], values[1]); };
  out.stage = in.stage();
  out.hand = vec2(in.hand());
  out.contact.proxy = vec2(in.proxy());
  out.contact.normal = vec2(in.normal());
  out.contact.touching = in.touching();
  out.contact.region = static_cast<std::uint8_t>(in.region());
  out.contact.wall = static_cast<std::uint8_t>(in.wall());
  out.contact.work = in.work();
  out.contact.unfinished = in.unfinished();
  out.effects.locked = in.locked();
  out.effects.place = in.place();
  out.effects.force = vec2(in.effects());
  return Status::ok();
}

}  // namespace

Status take_all(const pb::RecordedTick& in, KeptTick& out) {
  out = KeptTick();
  if (Status taken = take(in, out); !taken) return taken;
  HapticOutput& came = out.came.out;
  if (!present(in.command())) return no_value("command", "is not whole");
  const bool sound = take(in.command(), came.link) == Reject::kNone;
  if (!sound || check(came.link) != Reject::kNone) return no_value("command", "is no state");
  for (const Status& taken :
       {take_reasons(in, came), take_forces(in, came), take_motion(in, out.given.in, came)}) {
    if (!taken) return taken;
  }
  if (in.order_says_size() != kSpeaks) {
    return no_value("order_says", "has " + std::to_string(in.order_says_size()) +
                                      " numbers, expected " + std::to_string(kSpeaks));
  }
  came.tool_distance = in.order_says(0);
  came.tool_angle = in.order_says(1);
  came.hand_latched = in.order_says(2);
  came.tool_id = in.tool_id();
  came.deviation = in.deviation();
  came.deviation_angle = in.deviation_angle();
  came.blending = in.blending();
  came.turning = in.turning();
  if (in.handle_size() > 0) {
    if (Status taken = check_numbers("handle", in.handle(), 6); !taken) return taken;
    out.handle.state = HandleState::kSound;
    out.handle.f_H_M = {vec3_at(in.handle(), 0), vec3_at(in.handle(), 1)};
  }
  out.came.has_walls = in.has_walls();
  if (!in.has_walls()) return Status::ok();
  out.turned = in.walls().turned();
  return take_walls(in.walls(), out.came.walls);
}

Status take_all(const pb::RecordedCycle& in, KeptCycle& out) {
  out = KeptCycle();
  if (Status taken = take(in, out); !taken) return taken;
  if (!present(in.state())) return no_value("state", "is not whole");
  const bool sound = take(in.state(), out.came.link) == Reject::kNone;
  if (!sound || check(out.came.link) != Reject::kNone) return no_value("state", "is no state");
  return Status::ok();
}

}  // namespace handrail
