#include "devices/spacemouse/spacemouse_device.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace handrail {
namespace {

// A device sends some 125 events a second; a loop that stood still for a second has caught up in
// one reading.
constexpr std::size_t kMostEvents = 128;

}  // namespace

SpaceMouseDevice::SpaceMouseDevice(const SpaceMouseOptions& options)
    : options_(options),
      capabilities_(deflection_capabilities(options.motion)),
      reopener_([path = options.socket] { return connect_spnav(spnav_socket_path(path)); },
                options.reopen_pause),
      hand_(options.motion) {
  capabilities_.name = "SpaceMouse";
  capabilities_.buttons = options.enable_button ? 3 : 2;
}

Status SpaceMouseDevice::open() {
  close();
  const Result<SpnavConnection> first = connect_spnav(spnav_socket_path(options_.socket));
  if (!first) return first.status();
  reopener_.start(&*first);
  hand_.reset();
  sample_ = HapticSample();
  moved_at_ = -kForever;
  started_ = false;
  open_ = true;
  return Status::ok();
}

HapticSample SpaceMouseDevice::read(Nanos now) noexcept {
  if (!open_) return {};
  if (started_ && now <= last_) return sample_;
  receive(now);
  const bool there = fd_ >= 0 && !stream_.state().unplugged;
  if (!there) {
    hand_.halt();
  } else if (started_) {
    const bool clutched = (buttons() & 1u) != 0;
    hand_.step(deflection(now), clutched, to_seconds(now - last_));
  }
  started_ = true;
  last_ = now;
  show(there);
  return sample_;
}

DeviceTrouble SpaceMouseDevice::trouble() const noexcept {
  return fixed_text<DeviceTrouble>(!open_ ? "it is not open"
                                   : fd_ < 0
                                       ? "spacenavd does not answer: is it installed and started?"
                                       : "it is unplugged, as spacenavd says");
}

void SpaceMouseDevice::receive(Nanos now) noexcept {
  SpnavConnection opened;
  if (fd_ < 0 && reopener_.take(opened)) fd_ = opened.fd;
  if (fd_ < 0) return;
  std::array<std::uint8_t, kMostEvents * kSpnavRecord> bytes;
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (n <= 0) return lose();
  const std::uint64_t motions = stream_.state().motions;
  if (!stream_.take({bytes.data(), static_cast<std::size_t>(n)})) return lose();
  if (stream_.state().motions != motions) moved_at_ = now;
}

void SpaceMouseDevice::lose() noexcept {
  reopener_.lost(std::exchange(fd_, -1));
  stream_.reset();
}

Deflection SpaceMouseDevice::deflection(Nanos now) const noexcept {
  Deflection out;
  if (now - moved_at_ > options_.patience) return out;
  // The daemon's frame is right, up, away from the user; turns about its third axis are counted
  // the other way as well (libspnav, spnav_posrot_moveobj).
  const auto& c = stream_.state().counts;
  out.move = Vec3(c[0], c[1], -static_cast<double>(c[2])) / options_.full_counts;
  out.turn = Vec3(c[3], c[4], -static_cast<double>(c[5])) / options_.full_counts;
  return out;
}

std::uint32_t SpaceMouseDevice::buttons() const noexcept {
  const std::uint32_t down = stream_.state().buttons;
  std::uint32_t out = (down >> options_.clutch_button & 1u) | (down >> options_.drop_button & 1u)
                                                                  << 1;
  if (options_.enable_button) out |= (down >> *options_.enable_button & 1u) << 2;
  return out;
}

void SpaceMouseDevice::show(bool there) noexcept {
  sample_.X_MH = hand_.pose();
  sample_.v_MH = hand_.velocity();
  sample_.buttons = there ? buttons() : 0;
  sample_.valid = there;
}

void SpaceMouseDevice::close() noexcept {
  reopener_.stop();
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  stream_.reset();
  open_ = false;
}

}  // namespace handrail
