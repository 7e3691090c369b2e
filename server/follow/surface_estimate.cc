#include "server/follow/surface_estimate.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kStep = 2.0;     // forces so far apart tell of a compliance [N]
constexpr double kSteps = 0.5;    // as long as no more time lies between: slides take longer [s]
constexpr double kKeep = 0.95;    // of what was told before, each time: twenty steps of a press
constexpr double kNearby = 0.05;  // of the plane's place, to follow a slide [s]
// Normals turned further apart than the bumper's cone has spare need other sums, and further apart
// than a friction of 0.3 turns a force they are of two surfaces [rad].
constexpr double kSameTurn = 0.02;
constexpr double kOtherTurn = 0.35;
constexpr double kOtherPlace =
    5e-3;                          // as far as 0.1 rad goes at kKept: begun there it is another [m]
constexpr double kTold = 1e-5;     // no way below it is told from the encoders' [m]
constexpr double kExpected = 3.0;  // so many times the force of a contact is not missed
constexpr double kDeep = 1e-3;     // nor so deep: flexing and rounding are less [m]
constexpr int kMissed = 3;         // readings in a row, as for a contact

double within(const BumperSettings& settings, double stiffness) {
  const double most = std::clamp(settings.stiffest, kSoftestSurface, kStiffestSurface);
  return std::isfinite(stiffness) ? std::clamp(stiffness, kSoftestSurface, most) : most;
}

Vec3 told_normal(const Vec3& n) { return from_octahedral(octahedral(n)); }

}  // namespace

// A contact, or its other normal: what was told along it begins anew. feel() places the plane.
void SurfaceEstimate::begin(const BumperSettings& settings, const Vec3& n,
                            double stiffness) noexcept {
  surface_ = Surface{n, 0.0, within(settings, stiffness)};
  since_ = kSteps;
  near_weight_ = ff_ = sf_ = 0.0;
  begun_ = true;
}

// Only where force and way both change along the normal do they tell of the compliance. A slide
// goes far, and a normal that is a little off takes a part of it for depth. Friction that comes,
// goes or turns round changes the force without a way.
void SurfaceEstimate::compare(const BumperSettings& settings, const BumperInput& in,
                              const Vec3& p_ST) noexcept {
  const Vec3& n = surface_->n_S;
  const Vec3 change = in.f_E_S - f_from_, way = p_ST - p_from_;
  const double force = n.dot(change), along = n.dot(way);
  since_ += in.dt;
  const bool changed = std::abs(force) > std::max(kStep, 6.0 * settings.noise);
  if (!changed && since_ < kSteps) return;
  const bool straight = (change - force * n).norm() <= std::abs(force) &&
                        (way - along * n).norm() <= std::abs(along) + kTold;
  if (since_ < kSteps && straight) {
    ff_ = kKeep * ff_ + force * force;
    sf_ = kKeep * sf_ + force * along;
    surface_->stiffness = within(settings, ff_ / std::max(0.0, -sf_));
  }
  p_from_ = p_ST;
  f_from_ = in.f_E_S;
  since_ = 0.0;
}

void SurfaceEstimate::feel(const BumperSettings& settings, const BumperInput& in,
                           const Vec3& p_ST) noexcept {
  compare(settings, in, p_ST);
  near_weight_ = (1.0 - in.dt / kNearby) * near_weight_ + 1.0;
  near_place_ += (surface_->n_S.dot(p_ST) - near_place_) / near_weight_;
  near_force_ += (surface_->n_S.dot(in.f_E_S) - near_force_) / near_weight_;
  surface_->d = std::clamp(near_place_ + near_force_ / surface_->stiffness, -kFarthestSurface,
                           kFarthestSurface);
}

void SurfaceEstimate::miss(const BumperSettings& settings, const Vec3& p_ST,
                           double force) noexcept {
  const double deep = -surface_->out_of(p_ST);
  const bool should = deep > kDeep && deep * surface_->stiffness > kExpected * settings.contact;
  missed_ = should && force < 0.5 * settings.contact ? missed_ + 1 : 0;
  if (missed_ >= kMissed || (p_ST - p_felt_).norm() > kKept) forget();
}

// The stiffness by what force and place have changed since little was felt: of the bumper's
// contact, which begins with a force, a soft surface would seem stiff. Not known, it is told as the
// stiffest.
double SurfaceEstimate::since_light(const Vec3& n, double place, double force) const noexcept {
  if (!light_) return kStiffestSurface;
  return (force - n.dot(light_->f_E_S)) / (std::max(0.0, n.dot(light_->p_ST) - place) + kTold);
}

void SurfaceEstimate::step(const BumperSettings& settings, const BumperInput& in,
                           const BumperState& bumper) noexcept {
  if (!in.fresh || !is_finite(in.f_E_S) || !is_finite(in.p_ST)) return;
  const Vec3& p_ST = bumper.tip_before(settings.sensor_lag, in.dt);
  const double size = in.f_E_S.norm();
  if (size <= 0.5 * settings.contact) light_ = Light{p_ST, in.f_E_S};
  if (!bumper.touching() || size <= settings.contact) {
    begun_ = begun_ && bumper.touching();
    if (surface_) miss(settings, p_ST, size);
    return;
  }
  missed_ = 0;
  const Vec3 n = told_normal(bumper.n_S);
  const double place = n.dot(p_ST), force = in.f_E_S.dot(n);
  const double first = since_light(n, place, force);
  if (!surface_ || n.dot(surface_->n_S) < std::cos(kOtherTurn)) {
    begin(settings, n, first);
  } else if (!begun_) {
    const double off = surface_->out_of(p_ST) + force / surface_->stiffness;
    begin(settings, n, std::abs(off) > kOtherPlace ? first : surface_->stiffness);
  } else if (n.dot(surface_->n_S) < std::cos(kSameTurn)) {
    begin(settings, n, surface_->stiffness);
  }
  p_felt_ = p_ST;
  feel(settings, in, p_ST);
}

}  // namespace handrail
