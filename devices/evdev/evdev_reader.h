// Follows an input device of the kernel's that may be unplugged.
#pragma once

#include "devices/evdev/evdev_file.h"
#include "devices/evdev/evdev_stream.h"
#include "devices/input/reopener.h"

namespace handrail {

// Takes what came, at most 128 events; more wait for the next. False where the device is gone, or
// what it said is not known. Real-time safe.
bool take_events(int fd, EvdevStream& stream) noexcept;

// Whether the device is there, and whether that has changed.
enum class EvdevTurn : std::uint8_t { kAway, kThere, kCame, kLeft };

// Opened anew whenever it is lost. Of one thread; listen() and what it left are real-time safe.
class EvdevReader {
 public:
  // `pause`: between two attempts to open it, from a millisecond on.
  EvdevReader(Reopener<EvdevOpened>::Open open, Nanos pause) : reopener_(std::move(open), pause) {}
  ~EvdevReader() { stop(); }

  // With what was opened, from here on its own.
  void start(const EvdevOpened& first) { reopener_.start(&first); }
  // Twice is fine.
  void stop() noexcept;
  // Takes what came. A device whose events the kernel had no room for is lost as well.
  EvdevTurn listen() noexcept;
  // What it says cannot be: it is lost, and opened again. Nothing where it is away. Real-time safe.
  void lose() noexcept;

  bool there() const noexcept { return opened_.fd >= 0; }
  // As it was opened last.
  const EvdevOpened& device() const noexcept { return opened_; }
  const EvdevState& state() const noexcept { return stream_.state(); }
  // As EvdevStream's.
  std::bitset<KEY_CNT> take_presses() noexcept { return stream_.take_presses(); }

 private:
  Reopener<EvdevOpened> reopener_;
  EvdevOpened opened_;
  EvdevStream stream_;
};

}  // namespace handrail
