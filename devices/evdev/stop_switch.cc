#include "devices/evdev/stop_switch.h"

#include <unistd.h>

namespace handrail {

StopSwitch::StopSwitch(const StopSwitchOptions& options, EvdevKernel& kernel)
    : options_(options),
      kernel_(kernel),
      reader_([this] { return open_device(); }, options.reopen_pause) {}

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
  reader_.start(*first);
  started_ = true;
  return Status::ok();
}

void StopSwitch::stop() noexcept {
  started_ = false;
  reader_.stop();
}

bool StopSwitch::is_open() noexcept {
  if (!started_) return true;
  (void)reader_.listen();
  if (!reader_.there()) return true;
  const std::bitset<KEY_CNT> down = reader_.state().keys | reader_.take_presses();
  return options_.key ? down[static_cast<std::size_t>(*options_.key)] : down.any();
}

}  // namespace handrail
