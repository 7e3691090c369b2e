// Places that pull the hand in and lock it, as the gears of a gearshift.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "server/effects/effect_input.h"

namespace handrail {

// Toward the place, at distance d of a radius r: f = F d / (r/2) up to r/2, F (r - d) / (r/2) from
// there to r, nothing beyond (dissertation 2.3.2, the locking of a gear; the shape is ours). The
// pull has a potential, F r / 2 deep, so that it gives back what it took; a small damper makes up
// for the half period by which a held force is late.
//
// The lock closes within r/2 and opens beyond r, both of the proxy: a hand that presses a lever
// past its gear, into the wall at the aisle's end, is still in gear.
//
// A stage may give a place another peak, which comes within 20 ms; one of 0 N does not lock.
class Detent {
 public:
  static constexpr EffectKind kKind = EffectKind::kDetent;
  Detent(const EffectSpec& e, const Plant&) noexcept {
    const bool own = !e.radii.empty();
    for (std::size_t i = 0; i < e.places.size(); ++i) {
      add(e.places[i], own ? e.radii[i] : e.radius, own ? e.peaks[i] : e.peak);
    }
  }
  // Up to kMostDetents places, further apart than 2 r; r and peak > 0.
  Detent(const std::vector<Vec2>& places, double radius, double peak) noexcept {
    for (const Vec2& place : places) add(place, radius, peak);
  }
  // Each with its own radius and peak, and further apart than both their radii.
  Detent(const std::vector<Vec2>& places, const std::vector<double>& radii,
         const std::vector<double>& peaks) noexcept {
    for (std::size_t i = 0; i < places.size(); ++i) add(places[i], radii[i], peaks[i]);
  }

  void restart(const Vec2&) noexcept {}

  Vec2 force(const EffectInput& in, EffectTick& tick) noexcept {
    if (in.detent_peaks != nullptr || changed_) change(in);
    move_lock(in.proxy, tick);
    tick.locked = locked_ >= 0;
    tick.place = locked_;
    for (int i = 0; i < count_; ++i) {
      const Place& place = places_[static_cast<std::size_t>(i)];
      const Vec2 back = place.at - in.hand;
      const double d2 = back.squaredNorm(), r = place.radius;
      if (d2 >= r * r) continue;
      const double d = std::sqrt(d2);
      const Vec2 f =
          d <= 0.5 * r ? Vec2(place.slope * back) : Vec2((place.slope * (r - d) / d) * back);
      tick.by_spring(f);
      return f - (0.75 * place.slope * in.dt * (1.0 - d / r)) * in.velocity;
    }
    return Vec2::Zero();
  }

  int locked() const noexcept { return locked_; }           // index of the place, -1: none
  double stiffness() const noexcept { return stiffness_; }  // of the steepest place [N/m]

 private:
  struct Place {
    Vec2 at = Vec2::Zero();
    double radius = 0.0;  // [m]
    double slope = 0.0;   // in force [N/m]
    double listed = 0.0;  // as the scene lists it [N/m]
    bool locks = true;
  };

  void add(const Vec2& at, double radius, double peak) noexcept {
    if (count_ == kMostDetents) return;
    const double slope = peak / (0.5 * radius);
    places_[static_cast<std::size_t>(count_++)] = {at, radius, slope, slope};
    stiffness_ = std::max(stiffness_, slope);
  }
  void change(const EffectInput& in) noexcept {
    constexpr double kSame = 1e-9;  // of what is listed
    changed_ = in.detent_peaks != nullptr;
    stiffness_ = 0.0;
    for (int i = 0; i < count_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Place& place = places_[k];
      const bool own = in.detent_peaks != nullptr && k < in.detent_peaks->size();
      const double wanted = own ? (*in.detent_peaks)[k] / (0.5 * place.radius) : place.listed;
      place.locks = wanted > 0.0;
      place.slope += changed_in(in.dt) * (wanted - place.slope);
      if (std::abs(wanted - place.slope) <= kSame * place.listed) place.slope = wanted;
      if (place.slope != place.listed) changed_ = true;
      stiffness_ = std::max(stiffness_, place.slope);
    }
  }
  void move_lock(const Vec2& proxy, EffectTick& tick) noexcept {
    // Closer to place i than this share of its radius.
    const auto within = [&](int i, double share) {
      const Place& place = places_[static_cast<std::size_t>(i)];
      const double reach = share * place.radius;
      return place.locks && (place.at - proxy).squaredNorm() <= reach * reach;
    };
    if (locked_ >= 0 && !within(locked_, 1.0)) {
      tick.tell({EffectEvent::Kind::kUnlocked, locked_});
      locked_ = -1;
    }
    for (int i = 0; i < count_ && locked_ < 0; ++i) {
      if (!within(i, 0.5)) continue;
      locked_ = i;
      tick.tell({EffectEvent::Kind::kLocked, i});
    }
  }

  std::array<Place, kMostDetents> places_{};
  int count_ = 0;
  double stiffness_ = 0.0;
  int locked_ = -1;
  bool changed_ = false;  // not all are as listed
};

}  // namespace handrail
