// What a slave may tell of a surface that its tip touches, true or not.
#pragma once

#include <limits>
#include <optional>

#include "server/lab/sequences/draw.h"
#include "server/model/link_state.h"

namespace handrail {

class SurfaceCourse {
 public:
  explicit SurfaceCourse(Draw& draw) noexcept
      : touch_(draw, 0.05, 1.0),
        step_(draw, 0.001, 0.002),
        mad_(draw, 0.001, 0.05),
        lost_(draw, 0.001, 0.1) {}

  // `elapsed` [s] later, near the tip that was commanded to `p_SU`.
  void tell(Draw& draw, double elapsed, const Vec3& p_SU, SlaveState& slave) noexcept {
    slave.surface.reset();
    slave.has_wrench = false;
    if (!touch_.step(draw, elapsed)) return;
    if (touch_.began()) surface_ = {draw.unit(), 0.0, std::pow(10.0, draw.between(1.5, 7.0))};
    if (touch_.began()) surface_.d = surface_.n_S.dot(p_SU) + draw.between(-5e-3, 5e-3);
    // Estimated anew: a little elsewhere, or more than is followed.
    if (step_.step(draw, elapsed) && step_.began()) {
      surface_.n_S = (surface_.n_S + draw.between(0.0, 1.0) * draw.unit()).normalized();
      surface_.d = surface_.n_S.dot(p_SU) + draw.between(-0.03, 0.03);
    }
    if (lost_.step(draw, elapsed)) return;
    slave.surface = surface_;
    slave.has_wrench = draw.chance(0.5);
    slave.f_E_S.force = draw.between(-20.0, 50.0) * surface_.n_S;
    if (mad_.step(draw, elapsed)) slave.surface = mad(draw);
  }

 private:
  // As nothing sound tells it.
  Surface mad(Draw& draw) const noexcept {
    constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
    Surface out = surface_;
    switch (draw.below(7)) {
      case 0: out.n_S = -out.n_S; break;
      case 1: out.n_S.y() = kNoNumber; break;
      case 2: out.d = kNoNumber; break;
      case 3: out.stiffness = kNoNumber; break;
      case 4: out.stiffness = draw.between(-1e3, 0.0); break;
      case 5: out.n_S *= draw.between(0.0, 2.0); break;
      default: out.d += draw.between(-kFarthestSurface, kFarthestSurface);
    }
    return out;
  }

  // In turn: it touches something; what it touches is estimated anew; what it tells is mad; it
  // tells nothing.
  Spell touch_, step_, mad_, lost_;
  Surface surface_;
};

}  // namespace handrail
