// What a device is given in each contact, and how it moves.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "server/base/plane.h"

namespace handrail {

// How long what is kicked is watched, in windows of a swing, and when it is kicked again [s].
inline constexpr double kSeconds = 6.0, kWindow = 2.0, kSecondKick = 1.0;
// What a contact may give beyond what the device takes, with ticks in time [J].
inline constexpr double kMostGiven = 1e-3;
// Chosen: what a swing may be more than a window before.
inline constexpr double kMoreSwing = 1.05;
// Chosen: of a device's counts, what a swing may be anyway.
inline constexpr double kSwingCounts = 2.0;
// A run of which that cannot say whether the swing grows, or whether the hand comes to rest, goes
// on: each time for so many times as long, at most to kLongestWatch. A swing that wanders by a
// tenth from window to window, as the widest seen do, is then known to 1.3 %, a quarter of what
// kMoreSwing lets pass.
inline constexpr double kWatchLonger = 4.0, kLongestWatch = 384.0;  // [s]
// Of the ticks, where they are late at random.
inline constexpr double kLateShare = 0.02;

// What is given in a contact is the work of the force so far, less what the device's own friction
// and damping took meanwhile: a spring that begins and ends at rest gives nothing, and before it
// has ended it has given less. A contact lasts for as long as a force is asked for;
// where places pull from afar, it is all of a run that begins where they pull no further.
class ContactMeter {
 public:
  // `count` of the encoder that is not seen through [m]: the work on the true way differs from that
  // on the way read by the integral of what is not read over the force, at most half a count times
  // all that the force changes by. Up to its largest and back that is the largest times a count.
  ContactMeter(bool whole_run, double count) noexcept : whole_run_(whole_run), count_(count) {}

  // A tick under `force` [N]: its work and what the device took meanwhile [J]. `more`: what may
  // have been made beside [J]: the tick was held longer than it was to be, or the law changed; of a
  // tick without a force it counts for the contact that begins within it.
  void add(bool pushed, double force, double work, double taken, double more) noexcept {
    if (pushed && !in_contact_) {
      if (!whole_run_) given_ = allowed_ = most_force_ = 0.0;
      allowed_ += before_;
      ++contacts_;
    }
    in_contact_ = pushed;
    before_ = more;
    if (!pushed) return;
    given_ += work - taken;
    allowed_ += more;
    most_force_ = std::max(most_force_, force);
    worst_ = std::max(worst_, given_);
    over_ = std::max(over_, given_ - allowed_ - count_ * most_force_);
  }

  int contacts() const noexcept { return contacts_; }
  double worst() const noexcept { return worst_; }  // given in a contact, at any time of it [J]
  double over() const noexcept { return over_; }    // the same less what may be made [J]

 private:
  bool whole_run_, in_contact_ = false;
  double count_;             // [m]
  double most_force_ = 0.0;  // of the contact [N]
  int contacts_ = 0;
  double before_ = 0.0, given_ = 0.0, allowed_ = 0.0, worst_ = 0.0, over_ = 0.0;
};

// Of places: their mean, and how far they lie apart.
class Swing {
 public:
  void add(const Vec2& p) noexcept {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
    sum_ += p;
    ++count_;
  }
  Vec2 mean() const noexcept { return sum_ / std::max(count_, 1); }
  // From side to side, along the axis where that is more [m].
  double peak_to_peak() const noexcept { return count_ > 0 ? (high_ - low_).maxCoeff() : 0.0; }

 private:
  Vec2 low_ = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high_ = Vec2::Constant(-std::numeric_limits<double>::infinity());
  Vec2 sum_ = Vec2::Zero();
  int count_ = 0;
};

// The mean way from side to side in the first and in the second half of them, without the very
// first; of an even number the one in the middle is in neither. At least three [m].
struct SwingHalves {
  explicit SwingHalves(const std::vector<Swing>& windows) noexcept {
    const std::size_t half = (windows.size() - 1) / 2;
    for (std::size_t i = 0; i < half; ++i) {
      first += windows[1 + i].peak_to_peak() / static_cast<double>(half);
      second += windows[windows.size() - 1 - i].peak_to_peak() / static_cast<double>(half);
    }
  }
  double first = 0.0, second = 0.0;
};

}  // namespace handrail
