#include "server/scene/effect_io.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/scene/field_check.h"
#include "server/scene/numbers.h"

namespace handrail {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

Vec2 point_of(const Numbers& v) {
  return v.size() == 2 ? Vec2(v[0] * kMm, v[1] * kMm) : Vec2(Vec2::Zero());
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

// Where the value of a field goes, by its name.
struct NumberField {
  const char* name;
  double EffectSpec::*to;
  double unit;
};
constexpr NumberField kNumbers[] = {
    {"coupling_n_mm", &EffectSpec::coupling, kNewtonPerMm},
    {"stiffness_n_mm", &EffectSpec::stiffness, kNewtonPerMm},
    {"c", &EffectSpec::c, 1.0},
    {"peak_n", &EffectSpec::peak, 1.0},
    {"force_n", &EffectSpec::peak, 1.0},
    {"radius_mm", &EffectSpec::radius, kMm},
    {"home_mm", &EffectSpec::radius, kMm},
};

// False for a field that no effect has.
bool take(const Message& in, const FieldDescriptor& field, EffectSpec& out) {
  const auto& r = *in.GetReflection();
  const std::string& name = field.name();
  for (const NumberField& number : kNumbers) {
    if (name != number.name) continue;
    out.*number.to = r.GetDouble(in, &field) * number.unit;
    return true;
  }
  if (name == "centre_mm" || name == "to_mm") {
    Numbers at;
    for (int i = 0; i < r.FieldSize(in, &field); ++i) at.Add(r.GetRepeatedDouble(in, &field, i));
    out.at = point_of(at);
    return true;
  }
  if (name == "clockwise" || name == "published_damper") {
    (name == "clockwise" ? out.clockwise : out.published_damper) = r.GetBool(in, &field);
    return true;
  }
  return false;
}

EffectKind kind_named(const std::string& name) {
  for (int i = 0; i < static_cast<int>(EffectKind::kCount); ++i) {
    if (name == name_of(static_cast<EffectKind>(i))) return static_cast<EffectKind>(i);
  }
  return EffectKind::kCount;
}

Problem effect_from(const pb::Effect& in, bool painted, EffectSpec& out) {
  std::vector<const FieldDescriptor*> given;
  in.GetReflection()->ListFields(in, &given);
  if (given.size() != 1) {
    return FieldProblem{"",
                        std::to_string(given.size()) + " effects in one entry, expected exactly 1"};
  }
  if (in.has_detent()) return detent_from(in.detent(), painted, out);
  const FieldDescriptor& effect = *given.front();
  out.kind = kind_named(effect.name());
  if (out.kind == EffectKind::kCount) {
    return FieldProblem{effect.name(), "this build has no such effect"};
  }
  const Message& parameters = in.GetReflection()->GetMessage(in, &effect);
  for (int i = 0; i < effect.message_type()->field_count(); ++i) {
    const FieldDescriptor& field = *effect.message_type()->field(i);
    if (!take(parameters, field, out)) {
      return FieldProblem{effect.name() + "." + field.name(), "no effect of this build has it"};
    }
  }
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
