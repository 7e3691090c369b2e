#include "devices/evdev/stop_switch.h"

#include <unistd.h>

#include <cerrno>
#include <utility>

namespace handrail {
namespace {

// As many as the kernel keeps for a device without axes, at least (EVDEV_BUF_PACKETS).
constexpr std::size_t kMostSwitchEvents = 64;

}  // namespace

StopSwitch::StopSwitch(const StopSwitchOptions& options, EvdevKernel& kernel)
    : options_(options), kernel_(kernel), reopener_([this] { return open_device(); }) {}

Result<EvdevOpened> StopSwitch::open_device() const {
  Result<EvdevOpened> opened = open_evdev(kernel_, options_.path, EvdevUse::kGrab);
  if (!opened) return opened;
  const bool usable = options_.key ? opened->has_key[static_cast<std::size_t>(*options_.key)]
                                   : opened->has_key.any();
  if (usable) return opened;
  ::close(opened->fd);
  return Status::error("input device " + options_.path + " (" + std::string(text_of(opened->name)) +
                       ") has no " +
                       (options_.key ? "key " + std::to_string(*options_.key) : "key at all") +
                       ", expected one that stops; `evtest " + options_.path + "` shows its keys");
}

Status StopSwitch::start() {
  stop();
  Result<EvdevOpened> first = open_device();
  if (!first) return first.status();
  reopener_.start(&*first);
  started_ = true;
  return Status::ok();
}

void StopSwitch::stop() noexcept {
  started_ = false;
  reopener_.stop();
  if (opened_.fd >= 0) ::close(opened_.fd);
  opened_.fd = -1;
}

bool StopSwitch::is_open() noexcept {
  if (!started_) return true;
  if (opened_.fd < 0) {
    if (!reopener_.take(opened_)) return true;
    stream_.begin(opened_.state);
  }
  if (!listen()) {
    reopener_.lost(std::exchange(opened_.fd, -1));
    return true;
  }
  const std::bitset<KEY_CNT> down = stream_.state().keys | stream_.take_presses();
  return options_.key ? down[static_cast<std::size_t>(*options_.key)] : down.any();
}

// False where the device is gone, or what it said is not known.
bool StopSwitch::listen() noexcept {
  std::array<std::uint8_t, kMostSwitchEvents * sizeof(input_event)> bytes;
  const ssize_t n = ::read(opened_.fd, bytes.data(), bytes.size());
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  return n > 0 && stream_.take({bytes.data(), static_cast<std::size_t>(n)});
}

}  // namespace handrail
