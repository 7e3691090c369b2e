#include "server/scene/effect_io.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/base/units.h"

namespace handrail {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;
using Problem = std::optional<FieldProblem>;

Vec2 point_of(const Numbers& v) {
  return v.size() == 2 ? Vec2(v[0] * kMm, v[1] * kMm) : Vec2(Vec2::Zero());
}

int given(const pb::Effect& e) {
  return e.has_wall() + e.has_viscous() + e.has_progressive() + e.has_detent() +
         e.has_return_spring() + e.has_coulomb() + e.has_one_way() + e.has_device_inertia() +
         e.has_device_friction() + e.has_device_quantisation() + e.has_device_force_limits();
}

Problem detent_from(const pb::Effect::Detent& in, bool painted, EffectSpec& out) {
  if (in.place_size() < (painted ? 0 : 1) || in.place_size() > kMostDetents) {
    return FieldProblem{
        "detent.place",
        std::to_string(in.place_size()) + " places, expected 1 to " + std::to_string(kMostDetents)};
  }
  out.kind = EffectKind::kDetent;
  out.radius = in.radius_mm() * kMm;
  out.peak = in.peak_n();
  for (int i = 0; i < in.place_size(); ++i) {
    const Vec2 at = point_of(in.place(i).at_mm());
    for (std::size_t j = 0; j < out.places.size(); ++j) {
      const double apart = (at - out.places[j]).norm();
      if (apart >= 2.0 * out.radius) continue;
      return FieldProblem{"detent.place[" + std::to_string(i) + "].at_mm",
                          number_text(std::round(apart / kMm * 1e6) / 1e6) + " mm from '" +
                              out.place_names[j] + "', expected at least twice the radius, " +
                              number_text(2.0 * in.radius_mm())};
    }
    out.places.push_back(at);
    out.place_names.push_back(in.place(i).name());
  }
  return std::nullopt;
}

Problem effect_from(const pb::Effect& in, bool painted, EffectSpec& out) {
  if (given(in) != 1) {
    return FieldProblem{"",
                        std::to_string(given(in)) + " effects in one entry, expected exactly 1"};
  }
  if (in.has_detent()) return detent_from(in.detent(), painted, out);
  if (in.has_wall()) out.kind = EffectKind::kWall;
  if (in.has_viscous()) {
    out.kind = EffectKind::kViscous;
    out.coupling = in.viscous().coupling_n_mm() * kNewtonPerMm;
  }
  if (in.has_progressive()) {
    out.kind = EffectKind::kProgressive;
    out.c = in.progressive().c();
    out.at = point_of(in.progressive().centre_mm());
    out.clockwise = in.progressive().clockwise();
    out.coupling = in.progressive().coupling_n_mm() * kNewtonPerMm;
  }
  if (in.has_return_spring()) {
    out.kind = EffectKind::kReturn;
    out.at = point_of(in.return_spring().to_mm());
    out.stiffness = in.return_spring().stiffness_n_mm() * kNewtonPerMm;
    out.peak = in.return_spring().peak_n();
    out.radius = in.return_spring().home_mm() * kMm;
  }
  if (in.has_coulomb()) {
    out.kind = EffectKind::kCoulomb;
    out.peak = in.coulomb().force_n();
    out.coupling = in.coulomb().coupling_n_mm() * kNewtonPerMm;
  }
  if (in.has_one_way()) {
    out.kind = EffectKind::kOneWay;
    out.coupling = in.one_way().stiffness_n_mm() * kNewtonPerMm;
  }
  if (in.has_device_inertia()) out.kind = EffectKind::kDeviceInertia;
  if (in.has_device_friction()) out.kind = EffectKind::kDeviceFriction;
  if (in.has_device_quantisation()) out.kind = EffectKind::kDeviceQuantisation;
  if (in.has_device_force_limits()) out.kind = EffectKind::kDeviceForceLimits;
  return std::nullopt;
}

}  // namespace

Problem effects_from(const google::protobuf::RepeatedPtrField<pb::Effect>& effects,
                     std::vector<EffectSpec>& out, bool painted) {
  out.clear();
  if (effects.size() > kMostEffects) {
    return FieldProblem{"effect", std::to_string(effects.size()) + " effects, expected at most " +
                                      std::to_string(kMostEffects)};
  }
  for (int i = 0; i < effects.size(); ++i) {
    const std::string path = "effect[" + std::to_string(i) + "]";
    EffectSpec spec;
    if (Problem p = effect_from(effects[i], painted, spec)) {
      p->path = path + (p->path.empty() ? "" : "." + p->path);
      return p;
    }
    const bool twice = std::any_of(out.begin(), out.end(),
                                   [&](const EffectSpec& e) { return e.kind == spec.kind; });
    if (twice) return FieldProblem{path, std::string(name_of(spec.kind)) + " is listed twice"};
    out.push_back(spec);
  }
  return std::nullopt;
}

}  // namespace handrail
