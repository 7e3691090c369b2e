#include "server/haptic/local_surface.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kUnit = 1e-6;  // on the squared length, as on the link

bool is_surface(const Surface& s) {
  return is_finite(s.n_S) && std::isfinite(s.d) && std::isfinite(s.stiffness) &&
         std::abs(s.n_S.squaredNorm() - 1.0) < kUnit && s.stiffness > 0.0;
}

// `from` turned toward `to` by at most `angle` [rad].
Vec3 turned(const Vec3& from, const Vec3& to, double angle) {
  const double apart = std::atan2(from.cross(to).norm(), from.dot(to));
  if (apart <= angle) return to;
  const Vec3 beside = (to - to.dot(from) * from).normalized();
  return (std::cos(angle) * from + std::sin(angle) * beside).normalized();
}

}  // namespace

// Turned about the hand: it is as deep afterwards, but for the plane's own step.
void LocalSurface::follow(const Surface& told, const Vec3& p, double dt) noexcept {
  double out = model_.out_of(p);
  const double most = kPlaneRate * dt;
  out += std::clamp(told.out_of(p) - out, -most, most);
  model_.n_S = turned(model_.n_S, told.n_S, kNormalRate * dt);
  model_.d = model_.n_S.dot(p) - out;
  model_.stiffness = told.stiffness;
}

// Whether the tip has been where the surface pushes for too long without being pushed.
bool LocalSurface::unfelt(const LocalSurfaceInput& in, double dt) noexcept {
  const double behind = -model_.out_of(in.p_ST);
  const double least = std::min(kFelt, kFeltShare * model_.stiffness * behind);
  const bool free =
      behind > kBehind && in.has_force && is_finite(in.f_E_S) && in.f_E_S.dot(model_.n_S) < least;
  behind_for_ = free ? behind_for_ + dt : 0.0;
  return behind_for_ > kUnfelt;
}

void LocalSurface::hear(const LocalSurfaceInput& in, double dt) noexcept {
  const bool sound = in.told && is_surface(*in.told);
  if (refused_ && !(in.told && *in.told == *refused_)) refused_.reset();
  if (!known_) {
    if (!sound || refused_) return;
    model_ = *in.told;
    known_ = true;
    fading_ = false;
    why_ = Reason::kNone;
    stiffness_ = behind_for_ = 0.0;
    return;
  }
  if (fading_) return;
  if (!in.told) return fade(Reason::kNone);
  const bool elsewhere = !sound || in.told->n_S.dot(model_.n_S) <= 0.0 ||
                         std::abs(in.told->out_of(in.p_SU) - model_.out_of(in.p_SU)) > kJump;
  if (elsewhere) return fade(Reason::kSurfaceElsewhere);
  follow(*in.told, in.p_SU, dt);
  if (unfelt(in, dt)) {
    refused_ = in.told;
    fade(Reason::kSurfaceNotFelt);
  }
}

LocalSurfaceForce LocalSurface::step(const LocalSurfaceInput& in, double dt) noexcept {
  hear(in, dt);
  if (!known_) return {};
  const double full = std::min(in.most_stiffness, model_.stiffness * in.scale * in.scale);
  const double most = in.most_stiffness * dt / kFade;
  stiffness_ += std::clamp((fading_ ? 0.0 : full) - stiffness_, -most, most);
  LocalSurfaceForce out;
  out.why = why_;
  out.n_S = model_.n_S;
  out.stiffness = stiffness_;
  const double deep = -model_.out_of(in.p_SU);
  out.push = stiffness_ * std::max(0.0, deep) / in.scale;
  // Where nothing stiff may be rendered the spring stays.
  const double grown = full > 0.0 ? std::clamp(stiffness_ / full, 0.0, 1.0) : 0.0;
  out.share = grown * std::clamp(1.0 + deep / kNear, 0.0, 1.0);
  if (fading_ && stiffness_ == 0.0) known_ = false;
  return out;
}

}  // namespace handrail
