// What a SpaceMouse counts at full deflection.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/spacemouse/spacemouse_device.h"
#include "devices/spacemouse/spnav_stream.h"

namespace handrail {

// The person pushes and turns the cap as far as it goes, both ways of each of the six axes, for at
// most 60 s; it ends by itself 3 s after the last of the twelve has grown. full_counts is then the
// least of the twelve, so that each reaches full deflection. Before, for 1.5 s, the cap is left
// alone: counts at rest would move the hand.
class SpaceMouseCalibration final : public SelfTest {
 public:
  // Takes `fd`, a connection to spacenavd, and closes it.
  SpaceMouseCalibration(int fd, const SpaceMouseOptions& options);
  ~SpaceMouseCalibration() override;

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  // Empty until it is known.
  std::string block() const override;

 private:
  static constexpr std::size_t kAxes = 6;

  bool receive();
  void learn(Nanos now);
  bool complete() const;
  int full_counts() const;

  int fd_;
  SpaceMouseOptions options_;
  SpnavStream stream_;
  bool started_ = false, over_ = false, lost_ = false, resting_ = true;
  Nanos began_ = 0, grew_at_ = 0;
  std::int32_t rest_ = 0;  // the largest while left alone [counts]
  std::array<std::int32_t, kAxes> least_{}, most_{};
};

}  // namespace handrail
