// An input device of the kernel as it is opened.
#pragma once

#include <array>
#include <bitset>
#include <string>

#include "devices/evdev/evdev_stream.h"
#include "server/base/fixed_text.h"
#include "server/base/status.h"

namespace handrail {

// Where the kernel has its input devices.
inline constexpr char kInputFolder[] = "/dev/input";

// What is asked of the kernel, as open(2) and ioctl(2). A test answers in its place.
class EvdevKernel {
 public:
  virtual ~EvdevKernel() = default;
  // For reading, without waiting. -1: errno says why.
  virtual int open(const char* path) noexcept;
  virtual int control(int fd, unsigned long request, void* argument) noexcept;
  // For writing too, without waiting: force feedback is begun by an event that is written.
  virtual int open_to_write(const char* path) noexcept;
  virtual bool write(int fd, const input_event& event) noexcept;
};

// The kernel itself.
EvdevKernel& evdev_kernel() noexcept;

struct EvdevRange {
  std::int32_t least = 0, most = 0, flat = 0;  // [counts]
  // From the middle to an end.
  double half() const noexcept { return 0.5 * (static_cast<double>(most) - least); }
  // Where `value` is, from -1 at `least` to 1 at `most`.
  double share(std::int32_t value) const noexcept {
    return (static_cast<double>(value) - least) / half() - 1.0;
  }
};

// Copied without throwing.
struct EvdevOpened {
  int fd = -1;  // never blocks
  FixedText<80> name{};
  FixedText<256> path{};
  std::bitset<KEY_CNT> has_key;
  std::bitset<ABS_CNT> has_axis;
  std::bitset<FF_CNT> has_effect;  // of force feedback
  std::array<EvdevRange, ABS_CNT> ranges{};
  EvdevState state;  // as it was opened
};

// How a device is had: kGrab keeps its events from every other program.
enum class EvdevUse { kShare, kGrab };

// Opens `path`. Waits for nobody. The error names the path, the cause and what to do.
Result<EvdevOpened> open_evdev(EvdevKernel& kernel, const std::string& path, EvdevUse use);

}  // namespace handrail
