// What the master's log says of its haptic device.
#pragma once

#include <optional>
#include <string>

#include "devices/haptic_device.h"
#include "server/base/time.h"

namespace handrail {

// All from one thread.
class DeviceWatch {
 public:
  // A trouble may come and go with each attempt to open a device: one line of it in so long. As
  // HandleWatch.
  static constexpr Nanos kPause = kSecond;

  // The line at `now`, if the device's trouble is another than what was said last: "haptic device:
  // ..."; empty trouble: it has none. Allocates then.
  std::optional<std::string> line(Nanos now, const DeviceTrouble& trouble) {
    if (trouble == said_ || now - said_at_ < kPause) return std::nullopt;
    said_ = trouble;
    said_at_ = now;
    const std::string text(text_of(trouble));
    return "haptic device: " + (text.empty() ? "its readings are valid again" : text);
  }

 private:
  DeviceTrouble said_{};
  Nanos said_at_ = -kForever;
};

}  // namespace handrail
