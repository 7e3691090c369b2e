#include "client/console/play/played_status.h"

#include <algorithm>
#include <string>
#include <utility>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/master/status_report.h"
#include "server/record/came_io.h"

namespace handrail {
namespace {

// What the link was like, from what the step was told of it and when it was.
LinkSnapshot link_of(const LinkView& view, const KeptTiming& timing, bool known, Nanos age,
                     Nanos now) {
  LinkSnapshot out;
  out.peer_epoch = known ? 1 : 0;
  if (known && age < kForever) out.received_at = now - age;
  out.peer_sent = timing.peer_sent;
  if (view.loop_age < kForever) out.echoed_sent = now - view.loop_age;
  out.round_trip = timing.round_trip;
  out.peer_age = view.peer_age;
  out.received_of_100 = view.received_of_100;
  out.peer_received_of_100 = view.peer_received_of_100;
  out.loss_share = known ? 1.0 - view.received_of_100 / 100.0 : 0.0;
  // Of who leads instead nothing but that somebody does.
  if (view.other_master) out.refused_at = now;
  return out;
}

// As wall_report() has it, of the walls' own stage.
WallReport walls_of(const KeptTick& tick, const Scene* scene) {
  WallReport out;
  out.present = tick.came.has_walls;
  if (!out.present) return out;
  const WallOutput& felt = tick.came.walls;
  out.stage = felt.stage;
  out.contact = felt.contact;
  out.hand = felt.hand;
  out.penetration = (felt.contact.proxy - felt.hand).norm();
  out.locked = felt.effects.locked;
  out.place = felt.effects.place;
  if (scene == nullptr || !scene->walls) return out;
  const auto& stages = scene->walls->stages;
  const auto stage = static_cast<std::size_t>(felt.stage);
  const double angle = stage < stages.size() ? stages[stage].pose.angle : 0.0;
  out.force = Pose2::turned(tick.came.out.f_H_M.force.head<2>(), -angle);
  return out;
}

bool has_screw(const Scene& scene) {
  return std::any_of(scene.effects.begin(), scene.effects.end(), [](const EffectSpec& effect) {
    return effect.kind == EffectKind::kProgressive;
  });
}

// What the loop counts the scene has names for.
void name_walls(const Scene& scene, const KeptTick& tick, pb::WallStatus& out) {
  if (!scene.walls) return;
  const auto& stages = scene.walls->stages;
  if (out.stage() < stages.size() && !stages[out.stage()].name.empty()) {
    out.set_stage_name(stages[out.stage()].name);
  }
  const auto& regions = scene.walls->regions;
  if (out.region() < regions.size()) out.set_region_name(regions[out.region()].name);
  if (has_screw(scene)) out.set_turned_rad(tick.turned);
  if (!out.locked()) return;
  const auto place = static_cast<std::size_t>(tick.came.walls.effects.place);
  for (const EffectSpec& effect : scene.effects) {
    if (effect.kind != EffectKind::kDetent || place >= effect.place_names.size()) continue;
    out.set_place(effect.place_names[place]);
  }
}

void name_scene(const Scene& scene, const SlaveState& slave, pb::Status& out) {
  for (const NamedTool& tool : scene.named_tools) {
    pb::NamedToolStatus& named = *out.add_named_tool();
    named.set_name(tool.name);
    named.set_kind(name_of(tool.call.kind));
  }
  if (out.has_walls()) return;
  if (scene.X_AT) out.set_mounted(true);
  show_joints(arm_of(scene), slave, out);
}

// What was of the master's computer at that time, and is not written down.
void leave_out(const pb::RecordedStart& start, Nanos calendar, pb::Status& out) {
  out.clear_realtime();
  out.clear_peer();
  out.clear_gate();
  out.clear_log_lost();
  out.clear_overruns();
  out.clear_loop_lateness_us();
  out.clear_datagrams_accepted();
  out.clear_datagrams_rejected();
  out.clear_hand_moving();
  out.clear_scene_epoch();
  out.mutable_ledger()->clear_way_out_order();
  pb::ProgramStatus& program = *out.mutable_program();
  program.Clear();
  program.set_version(shown(start.version()));
  program.set_calendar_s(to_seconds(calendar));
}

MasterIdentity identity_of(const pb::RecordedStart& start) {
  MasterIdentity out;
  const pb::RecordedDevice& device = start.device();
  out.device = shown(device.name());
  out.device_simulated = device.simulated();
  if (device.workspace_half_size() == 3) {
    out.workspace_half =
        Vec3(device.workspace_half(0), device.workspace_half(1), device.workspace_half(2));
  }
  out.max_force = device.max_force();
  out.device_turns = device.senses_rotation();
  return out;
}

Result<pb::Status> status_of(const pb::RecordedStart& start, const pb::RecordedTick& recorded,
                             Nanos calendar, const Scene* scene) {
  KeptTick tick;
  if (Status taken = take_all(recorded, tick); !taken) {
    return Status::error("tick " + std::to_string(recorded.number()) + ": " + taken.message());
  }
  const HapticInput& in = tick.given.in;
  HapticReport report;
  report.out = tick.came.out;
  report.X_MH = in.hand.X_MH;
  report.walls = walls_of(tick, scene);
  report.handle = tick.handle;
  report.ticks = tick.number;
  const LinkSnapshot link = link_of(in.link, tick.timing, in.slave_known, in.slave_age, tick.at);
  pb::Status out = status_report(identity_of(start), report, in.slave, link, tick.at);
  leave_out(start, calendar, out);
  // The master goes on with the last that was one.
  if (!in.hand.valid || !is_place(in.hand.X_MH)) out.clear_hand();
  if (scene == nullptr) return out;
  name_scene(*scene, in.slave, out);
  if (out.has_walls()) name_walls(*scene, tick, *out.mutable_walls());
  return out;
}

// The slave's own view: of the master what it has heard.
Result<pb::Status> status_of(const pb::RecordedStart& start, const pb::RecordedCycle& recorded,
                             Nanos calendar, const Scene* scene) {
  KeptCycle cycle;
  if (Status taken = take_all(recorded, cycle); !taken) {
    return Status::error("cycle " + std::to_string(recorded.number()) + ": " + taken.message());
  }
  const FollowInput& in = cycle.given;
  const SlaveState& slave = cycle.came.link;
  HapticReport report;
  report.out.link = in.master;
  report.out.link.scene = slave.scene;
  report.out.reason = slave.state == SessionState::kFault ? slave.fault : slave.reason;
  report.ticks = cycle.number;
  LinkSnapshot link = link_of(in.link, cycle.timing, in.master_known, in.master_age, cycle.at);
  link.peer_epoch = 1;  // the slave itself is always heard
  pb::Status out = status_report({}, report, slave, link, cycle.at);
  leave_out(start, calendar, out);
  out.clear_device();
  out.clear_device_simulated();
  out.clear_haptic();
  out.clear_hand();
  out.clear_tool_force();
  out.clear_spring_force();
  out.clear_limited_force();
  out.clear_device_force();
  out.clear_hash_mismatch();
  // Of the ways of force and motion only why the arm holds.
  const std::string sentence = out.ledger().sentence();
  out.mutable_ledger()->Clear();
  out.mutable_ledger()->set_sentence(sentence);
  if (scene != nullptr) name_scene(*scene, slave, out);
  return out;
}

}  // namespace

std::uint32_t scene_number(bool of_master, const RecordingMoment& moment) {
  return of_master ? moment.tick.scene() : moment.cycle.scene();
}

Result<pb::Status> played_status(const pb::RecordedStart& start, bool of_master,
                                 const RecordingMoment& moment, const Scene* scene) {
  return of_master ? status_of(start, moment.tick, moment.calendar, scene)
                   : status_of(start, moment.cycle, moment.calendar, scene);
}

}  // namespace handrail
