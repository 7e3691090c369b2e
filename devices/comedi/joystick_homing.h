// Where the middle of a stick is whose encoders tell only how far it went.
#pragma once

#include <array>
#include <cstdint>

namespace handrail {

using StickWays = std::array<double, 2>;  // at the tip, right-left and up-down [m]

enum class StickHoming : std::uint8_t {
  kStops,   // moved by hand to its stops: the middle is between them
  kCentre,  // it stands in its middle when it is opened
};

// Follows a stick until its middle is known. Nothing of it moves the stick. Real-time safe.
class JoystickHoming {
 public:
  // `travel`: from stop to stop [m], > 0.
  JoystickHoming(StickHoming how, double travel) : how_(how), travel_(travel) {}

  // The next reading. False: the middle is not known yet. Once it is it stays: a reading beyond
  // what was seen before does not shift the hand.
  bool step(const StickWays& way) noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      if (!began_ || way[i] < least_[i]) least_[i] = way[i];
      if (!began_ || way[i] > most_[i]) most_[i] = way[i];
    }
    began_ = true;
    if (homed_) return true;
    if (how_ == StickHoming::kCentre) {
      middle_ = way;
      homed_ = true;
    } else if (reached(0) && reached(1)) {
      for (std::size_t i = 0; i < 2; ++i) middle_[i] = 0.5 * (least_[i] + most_[i]);
      homed_ = true;
    }
    return homed_;
  }

  bool homed() const noexcept { return homed_; }
  const StickWays& middle() const noexcept { return middle_; }
  // How far it has been from one side to the other, ever [m].
  StickWays seen() const noexcept { return {most_[0] - least_[0], most_[1] - least_[1]}; }
  // Both stops of this motor were reached, as nearly as they give way.
  bool reached(std::size_t i) const noexcept {
    return most_[i] - least_[i] >= travel_ - kStopGives;
  }
  // It went further than there is room for: counts are missed, or there are more a turn.
  bool too_far() const noexcept {
    return seen()[0] > kTooFar * travel_ || seen()[1] > kTooFar * travel_;
  }

 private:
  static constexpr double kStopGives = 0.004;  // of rubber, both together; our choice [m]
  static constexpr double kTooFar = 1.1;       // as a chord of 200 mm is an arc of 219

  StickHoming how_;
  double travel_;
  bool began_ = false, homed_ = false;
  StickWays least_{}, most_{}, middle_{};
};

}  // namespace handrail
