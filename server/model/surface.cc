#include "server/model/surface.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kSteps = 32767.0;

double sign_of(double v) { return v < 0.0 ? -1.0 : 1.0; }

// The lower half's triangles turned out over the edges of the square, and back.
void fold(double& u, double& v) {
  const double x = u;
  u = (1.0 - std::abs(v)) * sign_of(u);
  v = (1.0 - std::abs(x)) * sign_of(v);
}

std::uint32_t bits_of(double coordinate) {
  const long steps = std::lround(std::clamp(coordinate, -1.0, 1.0) * kSteps);
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

double from_bits(std::uint32_t bits) {
  const auto steps = static_cast<std::int16_t>(static_cast<std::uint16_t>(bits & 0xffff));
  return std::max(-1.0, steps / kSteps);
}

}  // namespace

std::uint32_t octahedral(const Vec3& n) noexcept {
  const double size = n.lpNorm<1>();
  double u = n.x() / size, v = n.y() / size;
  if (n.z() < 0.0) fold(u, v);
  return bits_of(u) | bits_of(v) << 16;
}

Vec3 from_octahedral(std::uint32_t code) noexcept {
  double u = from_bits(code), v = from_bits(code >> 16);
  const double z = 1.0 - std::abs(u) - std::abs(v);
  if (z < 0.0) fold(u, v);
  return Vec3(u, v, z).normalized();
}

}  // namespace handrail
