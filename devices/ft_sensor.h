// The narrow interface to a six-axis force/torque sensor.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/spatial.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

struct FtCapabilities {
  std::string name;
  double range_force = 0.0;   // |reading| per axis that still counts as unsaturated [N]
  double range_torque = 0.0;  // [N m]
};

// One record. `wrench` is what the environment exerts on the sensor, in the sensor's frame, whose
// axes are those of the tip frame T.
struct FtSample {
  Wrench wrench;
  std::uint32_t sequence = 0;  // the sensor's own counter
  std::uint32_t status = 0;    // non-zero: the sensor reports a fault; the wrench must not be used
  bool overrange = false;      // that fault is an axis beyond its range; false while status is 0
};

// A streaming sensor. All methods from one thread.
class FtSensor {
 public:
  virtual ~FtSensor() = default;
  virtual const FtCapabilities& capabilities() const = 0;
  // Asks the sensor to stream without end. Does not wait for the first record.
  virtual Status start() = 0;
  // Takes the newest record that arrived since the last call, never one older (by the sensor's
  // counter) than a record already given; asks again for the stream when none has come for 100 ms.
  // False: nothing new. Real-time safe.
  virtual bool poll(Nanos now, FtSample& sample) noexcept = 0;
  // Takes the present reading as zero.
  virtual void bias() noexcept = 0;
  virtual void stop() noexcept = 0;
};

}  // namespace handrail
