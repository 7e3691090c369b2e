// Reads the force sensor on the handle, in the master's IO thread.
#pragma once

#include <optional>
#include <string>

#include "devices/ft_sensor.h"
#include "server/base/spatial.h"
#include "server/base/time.h"
#include "server/model/handle_force.h"

namespace handrail {

struct HandleWatchOptions {
  Quat q_HF = Quat::Identity();  // of the sensor's axes in the handle's: its range is along them
  // The sensor's zero is the mean of what it reads while nothing is engaged and no force is asked
  // for. False: as it comes, of a simulated one.
  bool takes_zero = true;
};

// Whatever becomes of the sensor alters nothing but what this says. All methods from one thread.
class HandleWatch {
 public:
  // Two periods of a hand's tremor, which is 8 to 12 Hz (devices/hand/hand_model.h), and as many
  // readings as a mean needs; our choice.
  static constexpr Nanos kZeroTime = 250 * kMillisecond;
  static constexpr int kLeastReadings = 10;
  // A sensor that streams is silent after it: when its client asks it again (devices/ft_sensor.h).
  static constexpr Nanos kPatience = 100 * kMillisecond;
  // So long a state must stand that may only be the start, and between two lines.
  static constexpr Nanos kLinePause = kSecond;

  // Not owned; started.
  HandleWatch(FtSensor& sensor, const HandleWatchOptions& options) noexcept
      : sensor_(sensor), options_(options) {}

  // At `now`; `quiet`: nothing is engaged and no force is asked for. True: reading() is another.
  bool step(Nanos now, bool quiet) noexcept;
  const HandleReading& reading() const noexcept { return reading_; }

  struct Line {
    bool bad = false;
    std::string text;
  };
  // What is new to be said of it at `now`, once each; at most one line a second. May allocate.
  std::optional<Line> line(Nanos now);

 private:
  HandleState judge(const FtSample& sample) const noexcept;
  void take_zero(Nanos now, bool quiet, const FtSample& sample) noexcept;
  void go(HandleState state, Nanos now) noexcept;

  FtSensor& sensor_;
  HandleWatchOptions options_;
  HandleReading reading_;
  bool zeroed_ = false;
  Wrench zero_, sum_;
  int count_ = 0;               // in sum_
  Nanos quiet_since_ = 0;       // of those
  Nanos heard_at_ = -kForever;  // the newest record
  Nanos since_ = 0;             // reading_.state is so
  HandleState said_ = HandleState::kNone;
  Nanos said_at_ = -kForever;
};

}  // namespace handrail
