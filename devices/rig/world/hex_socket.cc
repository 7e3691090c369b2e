#include "devices/rig/world/hex_socket.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

constexpr double kSixth = std::numbers::pi / 3.0;
constexpr double kGuideSlope = 0.2;  // how fast the guide's walls close in

// The part of a rotation that turns about Z.
double spin_of(const Quat& q) noexcept { return 2.0 * std::atan2(q.z(), q.w()); }

}  // namespace

HexSocket::HexSocket(const HexSocketSpec& spec, double bending) noexcept
    : spec_(spec),
      X_SK_(spec.X_SK),
      X_KS_(inverse(spec.X_SK)),
      bending_(bending),
      clearance_(0.5 * (spec.across_flats - spec.key)),
      mouth_(clearance_ + kGuideSlope * spec.guide + spec.chamfer) {
  for (std::size_t i = 0; i < flats_.size(); ++i) {
    const double angle = kSixth * (static_cast<double>(i) + 0.5);
    flats_[i] = Vec3(std::cos(angle), std::sin(angle), 0.0);
    sides_[i].law = spec.surface;
  }
  rim_.law = bottom_.law = clamp_.law = spec.surface;
  rim_.n = bottom_.n = clamp_.n = axis();
  rim_.offset = rim_.n.dot(X_SK_.p);
}

// How far out of the axis, as the hexagon measures it.
double HexSocket::across(const Vec3& p_K) const noexcept {
  double out = 0.0;
  for (const Vec3& flat : flats_) out = std::max(out, flat.dot(p_K));
  return out;
}

double HexSocket::off_flats(double turn) const noexcept {
  return std::remainder(spin_ - turn, kSixth);
}

bool HexSocket::fits(double turn) const noexcept {
  return std::abs(off_flats(turn)) <= 0.5 * spec_.backlash && tilt_ <= kLost;
}

void HexSocket::clear_all() noexcept {
  for (Contact& side : sides_) side.clear();
  rim_.clear();
  bottom_.clear();
  clamp_.clear();
}

// Six slopes that let the tip `reach` from the axis at height `at_z` and
// `steepness` more for each metre above.
void HexSocket::slopes(double steepness, double reach, double at_z, ContactList& out) noexcept {
  const double length = std::sqrt(1.0 + steepness * steepness);
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Vec3 n_K = (steepness * Vec3::UnitZ() - flats_[i]) / length;
    sides_[i].n = X_SK_.q * n_K;
    sides_[i].offset = sides_[i].n.dot(X_SK_.p) + (steepness * at_z - reach) / length;
    out.add(sides_[i]);
  }
}

void HexSocket::find(const TipStep& tip, double turn, ContactList& out) noexcept {
  const Vec3 last = in_socket(tip.x_last), next = in_socket(tip.y);
  const Zone before = zone_;
  const bool over = across(next) <= mouth_;
  if (zone_ == Zone::kBeside && over) zone_ = Zone::kMouth;
  if (zone_ == Zone::kMouth && !over) zone_ = Zone::kBeside;
  if (zone_ == Zone::kMouth && last.z() < -spec_.chamfer && fits(turn)) {
    zone_ = Zone::kInside;
    turns_ = kSixth * std::round((spin_ - turn) / kSixth);
  }
  if (zone_ == Zone::kInside && last.z() > -spec_.chamfer) zone_ = Zone::kMouth;
  if (zone_ != before && (zone_ == Zone::kBeside || before == Zone::kBeside)) clear_all();
  if (zone_ == Zone::kBeside) {
    out.add(rim_);
    return;
  }
  const double guide_end = -(spec_.chamfer + spec_.guide);
  if (zone_ == Zone::kMouth) {
    slopes(1.0, mouth_, 0.0, out);
  } else if (last.z() > guide_end) {
    slopes(kGuideSlope, clearance_, guide_end, out);
  } else {
    slopes(0.0, clearance_, guide_end, out);
  }
  // The corners stand on the chamfer's end until they fit.
  const bool blocked = zone_ == Zone::kMouth && !fits(turn);
  if (blocked || zone_ == Zone::kInside) {
    bottom_.offset = bottom_.n.dot(X_SK_.p) - (blocked ? spec_.chamfer : spec_.depth);
    out.add(bottom_);
  } else {
    bottom_.clear();
  }
  if (!jammed()) {
    clamp_.clear();
    return;
  }
  if (!clamp_.touching()) clamp_.anchor = tip.x_last;
  // Two walls push, the further apart the more of the flats is inside, and each rubs.
  const double whole = spec_.depth - spec_.chamfer;
  const double push = bending_ * (tilt_ - spec_.jam) * engaged_ / (whole * whole);
  clamp_.grip = 2.0 * spec_.surface.friction * push;
  out.add(clamp_);
}

void HexSocket::settle(const Pose& X_ST) noexcept {
  const Pose X_KT = X_KS_ * X_ST;
  const Vec3 down = X_KT.q * Vec3::UnitZ();
  tilt_ = std::acos(std::clamp(-down.z(), -1.0, 1.0));
  // The tool looks into the socket: half a turn about X lays its frame on the
  // socket's.
  const double spin = spin_of(X_KT.q * Quat(0.0, 1.0, 0.0, 0.0));
  spin_ += std::remainder(spin - spin_, 2.0 * std::numbers::pi);
  const bool over = across(X_KT.p) <= mouth_;
  depth_ = over ? -X_KT.p.z() : -std::numeric_limits<double>::infinity();
  engaged_ = std::max(0.0, -X_KT.p.z() - spec_.chamfer);
}

}  // namespace handrail
