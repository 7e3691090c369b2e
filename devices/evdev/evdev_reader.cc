#include "devices/evdev/evdev_reader.h"

#include <unistd.h>

#include <cerrno>
#include <utility>

namespace handrail {
namespace {

// A device sends some hundred events a second; a loop that stood still for a second has caught up
// in one reading. The kernel keeps 64 at least (EVDEV_BUF_PACKETS).
constexpr std::size_t kMostEvdevEvents = 128;

}  // namespace

bool take_events(int fd, EvdevStream& stream) noexcept {
  std::array<std::uint8_t, kMostEvdevEvents * sizeof(input_event)> bytes;
  const ssize_t n = ::read(fd, bytes.data(), bytes.size());
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  return n > 0 && stream.take({bytes.data(), static_cast<std::size_t>(n)});
}

EvdevTurn EvdevReader::listen() noexcept {
  const bool was_there = there();
  if (!was_there) {
    if (!reopener_.take(opened_)) return EvdevTurn::kAway;
    stream_.begin(opened_.state);
  }
  if (take_events(opened_.fd, stream_)) return was_there ? EvdevTurn::kThere : EvdevTurn::kCame;
  lose();
  return EvdevTurn::kLeft;
}

void EvdevReader::lose() noexcept {
  if (there()) reopener_.lost(std::exchange(opened_.fd, -1));
}

void EvdevReader::stop() noexcept {
  reopener_.stop();
  if (there()) ::close(opened_.fd);
  opened_.fd = -1;
}

}  // namespace handrail
