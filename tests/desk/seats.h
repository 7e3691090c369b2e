// Haptic devices, each with what stands in for its hardware, moved by somebody.
#pragma once

#include <memory>
#include <span>

#include "devices/haptic_device.h"
#include "server/base/status.h"

namespace handrail::desk {

// A device and its stand-in, as long as it lives.
class Seat {
 public:
  virtual ~Seat() = default;
  // Not yet open.
  virtual HapticDevice& device() = 0;
  // Somebody moves it from here on, while it is open, to there.
  virtual void begin() = 0;
  virtual void end() = 0;
};

struct SeatRow {
  const char* name;    // as `handrail devices` calls it
  const char* behind;  // what stands in, and how often it moves
  // The error says what is missing here.
  Result<std::unique_ptr<Seat>> (*make)();
};

// The first is the simulated device that the others are compared with.
std::span<const SeatRow> seat_rows();

}  // namespace handrail::desk
