#include "server/scene/payload_io.h"
#include "server/scene/numbers.h"

#include <cstdio>

namespace handrail {
namespace {

void put(const Vec3& v, Numbers* out) { out->Add(v.begin(), v.end()); }

std::string line(const char* field, int decimals, const Vec3& v) {
  char text[160];
  std::snprintf(text, sizeof text, "  %s: [%.*f, %.*f, %.*f]\n", field, decimals, v.x(), decimals,
                v.y(), decimals, v.z());
  return text;
}

}  // namespace

Payload payload_from(const pb::PayloadConfig& in) {
  return {in.mass_kg(),
          vector_of(in.centre_mm()) * kMm,
          {vector_of(in.bias_n()), vector_of(in.bias_n_m())}};
}

pb::PayloadConfig payload_config(const Payload& payload) {
  pb::PayloadConfig out;
  out.set_mass_kg(payload.mass);
  put(payload.centre_T / kMm, out.mutable_centre_mm());
  put(payload.bias_T.force, out.mutable_bias_n());
  put(payload.bias_T.torque, out.mutable_bias_n_m());
  return out;
}

std::string payload_text(const Payload& payload) {
  char mass[64];
  std::snprintf(mass, sizeof mass, "  mass_kg: %.4f\n", payload.mass);
  return std::string("payload {\n") + mass + line("centre_mm", 2, payload.centre_T / kMm) +
         line("bias_n", 3, payload.bias_T.force) + line("bias_n_m", 5, payload.bias_T.torque) +
         "}\n";
}

}  // namespace handrail
