#include "server/scene/simulate_io.h"

#include <algorithm>
#include <string>

#include "server/base/plain_text.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"

namespace handrail {
namespace {

Problem unit_from(const char* field, const Numbers& v, Vec3& out) {
  const Vec3 given = vector_of(v);
  if (given.norm() < 1e-9) return FieldProblem{field, "has no direction"};
  out = given.normalized();
  return std::nullopt;
}

SurfaceSpec surface_from(const pb::RigEffect::Surface& in) {
  constexpr double kNewtonSecondPerMm = 1e3;
  return {in.n_mm() * kNewtonPerMm, in.n_s_mm() * kNewtonSecondPerMm, in.friction()};
}

BacklashSpec backlash_from(const pb::RigEffect::Backlash& in) {
  BacklashSpec out;
  for (int i = 0; i < kJoints; ++i) out.play[i] = in.joint_deg(i) * kDeg;
  return out;
}

GravitySpec gravity_from(const pb::RigEffect::Gravity& in) {
  GravitySpec out;
  out.mass = in.payload_kg();
  out.p_TC = vector_of(in.centre_mm()) * kMm;
  for (int i = 0; i < in.joint_n_m_rad_size(); ++i) out.stiffness[i] = in.joint_n_m_rad(i);
  return out;
}

Problem plane_from(const pb::RigEffect::Plane& in, RigEffectSpec& out) {
  PlaneSpec plane;
  plane.at = vector_of(in.at_mm()) * kMm;
  plane.surface = surface_from(in.surface());
  Problem problem = unit_from("plane.normal", in.normal(), plane.normal);
  out = plane;
  return problem;
}

BoxSpec box_from(const pb::RigEffect::Box& in) {
  BoxSpec out;
  out.X_SB = {vector_of(in.at_mm()) * kMm, rotation_exp(vector_of(in.turn_deg()) * kDeg)};
  out.half = 0.5 * vector_of(in.size_mm()) * kMm;
  out.surface = surface_from(in.surface());
  return out;
}

Problem cylinder_from(const pb::RigEffect::Cylinder& in, RigEffectSpec& out) {
  CylinderSpec cylinder;
  cylinder.at = vector_of(in.at_mm()) * kMm;
  cylinder.radius = in.radius_mm() * kMm;
  cylinder.half_length = 0.5 * in.length_mm() * kMm;
  cylinder.hole = in.hole();
  cylinder.surface = surface_from(in.surface());
  Problem problem = unit_from("cylinder.axis", in.axis(), cylinder.axis);
  out = cylinder;
  return problem;
}

// Z out of the socket; X as near to the base's X as that allows.
Quat socket_axes(const Vec3& axis) { return smallest_turn(Vec3::UnitZ(), axis); }

Problem socket_from(const pb::RigEffect::HexSocket& in, RigEffectSpec& out) {
  if (in.key_mm() >= in.across_flats_mm()) {
    const char* field = in.has_key_mm() ? "hex_socket.key_mm" : "hex_socket.across_flats_mm";
    return FieldProblem{field, "key_mm " + number_text(in.key_mm()) +
                                   " does not fit across_flats_mm " +
                                   number_text(in.across_flats_mm())};
  }
  const double lead_in = in.chamfer_mm() + in.guide_mm();
  if (in.depth_mm() <= lead_in) {
    const char* field = in.has_depth_mm() ? "hex_socket.depth_mm" : "hex_socket";
    return FieldProblem{field, number_text(in.depth_mm()) +
                                   " is not below chamfer_mm and guide_mm, which end at " +
                                   number_text(lead_in) + " mm"};
  }
  // A key pressed through softer walls would not be in a socket any more.
  constexpr double kSoftest = 100.0;  // [N/mm]
  if (in.surface().n_mm() < kSoftest) {
    return FieldProblem{"hex_socket.surface.n_mm",
                        number_text(in.surface().n_mm()) +
                            " is too soft for a socket, expected at least " +
                            number_text(kSoftest) + " N/mm"};
  }
  Vec3 axis;
  if (Problem p = unit_from("hex_socket.axis", in.axis(), axis)) return p;
  HexSocketSpec socket;
  socket.X_SK = {vector_of(in.at_mm()) * kMm, socket_axes(axis)};
  socket.across_flats = in.across_flats_mm() * kMm;
  socket.key = in.key_mm() * kMm;
  socket.depth = in.depth_mm() * kMm;
  socket.chamfer = in.chamfer_mm() * kMm;
  socket.guide = in.guide_mm() * kMm;
  socket.backlash = in.backlash_deg() * kDeg;
  socket.jam = in.jam_deg() * kDeg;
  socket.surface = surface_from(in.surface());
  out = socket;
  return std::nullopt;
}

ScrewThreadSpec thread_from(const pb::RigEffect::ScrewThread& in) {
  return {in.start_n_m(), in.seat_deg() * kDeg, in.growth_n_m_rad(), in.back_share()};
}

int given(const pb::RigEffect& e) {
  return e.has_servo_lag() + e.has_encoder_offsets() + e.has_joint_backlash() +
         e.has_gravity_sag() + e.has_arm_compliance() + e.has_tool_compliance() + e.has_plane() +
         e.has_box() + e.has_cylinder() + e.has_hex_socket() + e.has_screw_thread() +
         e.has_sensor_noise() + e.has_sensor_drift() + e.has_sensor_quantisation() +
         e.has_sensor_saturation();
}

Problem effect_from(const pb::RigEffect& in, RigEffectSpec& out) {
  if (given(in) != 1) {
    return FieldProblem{"",
                        std::to_string(given(in)) + " effects in one entry, expected exactly 1"};
  }
  if (in.has_plane()) return plane_from(in.plane(), out);
  if (in.has_cylinder()) return cylinder_from(in.cylinder(), out);
  if (in.has_hex_socket()) return socket_from(in.hex_socket(), out);
  if (in.has_box()) out = box_from(in.box());
  if (in.has_servo_lag()) {
    out = ServoLagSpec{in.servo_lag().lag_ms() * 1e-3, in.servo_lag().spread()};
  }
  if (in.has_encoder_offsets()) {
    out = EncoderOffsetsSpec{in.encoder_offsets().repeatability_mm() * kMm};
  }
  if (in.has_joint_backlash()) out = backlash_from(in.joint_backlash());
  if (in.has_gravity_sag()) out = gravity_from(in.gravity_sag());
  if (in.has_arm_compliance()) {
    out = ArmComplianceSpec{in.arm_compliance().n_mm() * kNewtonPerMm};
  }
  if (in.has_tool_compliance()) {
    const auto& tool = in.tool_compliance();
    out = ToolComplianceSpec{tool.axial_n_mm() * kNewtonPerMm, tool.lateral_n_mm() * kNewtonPerMm,
                             tool.twist_n_m_rad()};
  }
  if (in.has_screw_thread()) out = thread_from(in.screw_thread());
  if (in.has_sensor_noise()) out = SensorNoiseSpec{in.sensor_noise().n(), in.sensor_noise().n_m()};
  if (in.has_sensor_drift()) {
    const auto& drift = in.sensor_drift();
    out = SensorDriftSpec{
        drift.n_per_s(), drift.n(), {vector_of(drift.start_n()), vector_of(drift.start_n_m())}};
  }
  if (in.has_sensor_quantisation()) {
    out = SensorQuantisationSpec{in.sensor_quantisation().n(), in.sensor_quantisation().n_m()};
  }
  if (in.has_sensor_saturation()) {
    out = SensorSaturationSpec{in.sensor_saturation().n(), in.sensor_saturation().n_m()};
  }
  return std::nullopt;
}

// Whether `spec` may join those read so far.
std::string why_not(const RigEffectSpec& spec, const Simulate& so_far) {
  const RigEffectKind kind = kind_of(spec);
  const auto& all = so_far.effects;
  const bool again = kind == RigEffectKind::kPlane || kind == RigEffectKind::kBox ||
                     kind == RigEffectKind::kCylinder;
  if (!again && std::any_of(all.begin(), all.end(),
                            [kind](const RigEffectSpec& e) { return kind_of(e) == kind; })) {
    return std::string(name_of(kind)) + " is listed twice";
  }
  const auto touched = std::count_if(all.begin(), all.end(),
                                     [](const RigEffectSpec& e) { return is_touched(kind_of(e)); });
  if (is_touched(kind) && touched >= kMostTouched) {
    return "more things to touch than " + std::to_string(kMostTouched);
  }
  return "";
}

}  // namespace

std::optional<FieldProblem> simulate_from(const pb::Simulate& in, Simulate& out) {
  out.effects.clear();
  std::string thread;
  for (int i = 0; i < in.effect_size(); ++i) {
    const std::string path = "simulate.effect[" + std::to_string(i) + "]";
    RigEffectSpec spec;
    if (Problem p = effect_from(in.effect(i), spec)) {
      p->path = path + (p->path.empty() ? "" : "." + p->path);
      return p;
    }
    if (const std::string why = why_not(spec, out); !why.empty()) return FieldProblem{path, why};
    if (in.effect(i).has_screw_thread()) thread = path + ".screw_thread";
    out.effects.push_back(spec);
  }
  if (!thread.empty() && out.find<HexSocketSpec>() == nullptr) {
    return FieldProblem{thread, "has no hex_socket, by which the screw is turned"};
  }
  return std::nullopt;
}

}  // namespace handrail
