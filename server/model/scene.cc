#include "server/model/scene.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "server/base/fnv.h"

namespace handrail {
namespace {

// What a call says, whatever stands on the other side of it.
void add_call(const ToolCall& call, Fnv& h) noexcept {
  h.byte(static_cast<std::uint8_t>(call.kind)).byte(call.at_present).byte(call.has_axis);
  h.byte(call.has_axis_T).byte(call.has_q_ref).byte(call.one_way).byte(call.has_end);
  for (const Vec3* v :
       {&call.p_SA, &call.direction_S, &call.normal_S, &call.axis_S, &call.axis_T, &call.p_SE}) {
    for (int i = 0; i < 3; ++i) h.f64((*v)[i]);
  }
  for (int i = 0; i < 4; ++i) h.f64(call.q_ref.coeffs()[i]);
  h.f64(call.stiffness);
}

}  // namespace

SectionHashes section_hashes(const Scene& scene) noexcept {
  Fnv mapping;
  mapping.f64(scene.mapping.scale);
  for (int i = 0; i < 9; ++i) mapping.f64(scene.mapping.R_SM(i / 3, i % 3));
  if (scene.mapping.absolute) {
    for (const Vec3* v : {&scene.mapping.hand_centre, &scene.mapping.tip_centre}) {
      for (int i = 0; i < 3; ++i) mapping.f64((*v)[i]);
    }
  }
  mapping.f64(scene.guidance.catch_up).f64(scene.guidance.catch_up_rotation);
  for (const NamedTool& tool : scene.named_tools) {
    for (const char c : tool.name) mapping.byte(static_cast<std::uint8_t>(c));
    mapping.byte(0);
    add_call(tool.call, mapping);
  }

  Fnv limits;
  const JointLimits& joints = scene.limits.joints;
  for (const JointVector* v : {&joints.lower, &joints.upper, &joints.max_speed,
                               &joints.max_acceleration, &joints.max_jerk}) {
    for (int i = 0; i < kJoints; ++i) limits.f64((*v)[i]);
  }
  for (const Vec3* v : {&scene.limits.workspace_low, &scene.limits.workspace_high}) {
    for (int i = 0; i < 3; ++i) limits.f64((*v)[i]);
  }
  limits.f64(scene.limits.tip_speed).byte(scene.bumper.enabled);
  const BumperSettings& bumper = scene.bumper;
  limits.f64(bumper.alpha).f64(bumper.threshold).f64(bumper.dead_band);
  limits.byte(static_cast<std::uint8_t>(bumper.form)).f64(bumper.contact).f64(bumper.friction);
  limits.f64(bumper.noise).f64(bumper.promise).f64(bumper.stiffest).f64(bumper.sensor_lag);

  SectionHashes out;
  out.mapping = mapping.value();
  out.limits = limits.value();
  Fnv robot;
  robot.f64(scene.tip_length);
  if (scene.X_AT) {
    for (int i = 0; i < 3; ++i) robot.f64(scene.X_AT->p[i]);
    for (int i = 0; i < 4; ++i) robot.f64(scene.X_AT->q.coeffs()[i]);
  }
  out.robot = robot.value();
  return out;
}

std::vector<std::string> warnings_of(const Scene& scene) {
  // Onset of instability against a stiff contact, alpha k_e, with 45 ms of servo lag and 50 ms of
  // delay.
  constexpr double kStiffContact = 100e3;  // [N/m]
  constexpr double kOnset = 2.1;
  constexpr double kPublishedStiffness = 800.0;  // rendered on an Omni at 1 kHz [N/m]
  std::vector<std::string> out;
  const bool published = scene.bumper.form == BumperSettings::Form::kPublished;
  if (scene.bumper.enabled && published && scene.bumper.alpha * kStiffContact > kOnset) {
    out.emplace_back(
        "bumper.alpha_mm_n: the bumper may oscillate against contacts as stiff as 100 N/mm");
  }
  if (!scene.bumper.enabled) out.emplace_back("bumper.enabled: false leaves contact unprotected");
  if (scene.guidance.stiffness > kPublishedStiffness) {
    out.emplace_back("guidance.stiffness_n_mm: above 0.8 N/mm an Omni may not render it stably");
  }
  if (scene.walls) {
    out.insert(out.end(), scene.walls->warnings.begin(), scene.walls->warnings.end());
    const bool felt = std::any_of(scene.effects.begin(), scene.effects.end(),
                                  [](const auto& e) { return e.kind == EffectKind::kWall; });
    if (!felt) out.emplace_back("effect: none is wall {}, so the hand feels nothing of the walls");
  }
  return out;
}

bool is_scene_name(const std::string& name) noexcept {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  };
  return !name.empty() && name.size() < std::tuple_size_v<SceneName> &&
         std::all_of(name.begin(), name.end(), allowed);
}

}  // namespace handrail
