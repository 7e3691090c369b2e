#include "server/lab/accuracy/contact_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {

Motion1 spring_motion(double mass, double damping, double stiffness, double rest,
                      const Motion1& from, double t) {
  const double decay = 0.5 * damping / mass;
  const double square = stiffness / mass - decay * decay;
  const double x = from.x - rest;
  // c = cos(w t), s = sin(w t) / w, and their like beyond critical damping.
  const double w = std::sqrt(std::abs(square));
  const double c = square >= 0.0 ? std::cos(w * t) : std::cosh(w * t);
  const double s = w == 0.0 ? t : (square >= 0.0 ? std::sin(w * t) : std::sinh(w * t)) / w;
  const double slope = from.v + decay * x;
  const double fade = std::exp(-decay * t);
  return {rest + fade * (x * c + slope * s),
          fade * (from.v * c - (decay * slope + square * x) * s)};
}

ExactContact::ExactContact(const ContactModel& model, const Motion1& from, double duration)
    : model_(model) {
  const double period =
      2.0 * std::numbers::pi * std::sqrt(model.mass / (model.stiffness + model.wall));
  const double look = period / 64.0;
  pieces_.push_back({0.0, from, from.x > 0.0 || (from.x == 0.0 && from.v > 0.0)});
  for (double t = 0.0; t < duration; t += look) {
    const Piece& piece = pieces_.back();
    const auto wrong_side = [&](double when) {
      const double x = within(piece, when).x;
      return piece.touching ? x < 0.0 : x > 0.0;
    };
    if (!wrong_side(t + look)) continue;
    double before = std::max(t, piece.start), after = t + look;
    while (after - before > 1e-15) {
      const double middle = 0.5 * (before + after);
      if (middle <= before || middle >= after) break;
      (wrong_side(middle) ? after : before) = middle;
    }
    pieces_.push_back({after, within(piece, after), !piece.touching});
  }
}

Motion1 ExactContact::within(const Piece& piece, double t) const {
  const double k = model_.stiffness + (piece.touching ? model_.wall : 0.0);
  return spring_motion(model_.mass, model_.damping, k, model_.stiffness * model_.rest / k,
                       piece.from, t - piece.start);
}

Motion1 ExactContact::at(double t) const {
  const auto next = std::upper_bound(pieces_.begin() + 1, pieces_.end(), t,
                                     [](double when, const Piece& p) { return when < p.start; });
  return within(*(next - 1), t);
}

}  // namespace handrail
