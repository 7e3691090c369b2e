// A SpaceMouse of 3Dconnexion behind the interface of a haptic device.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "devices/haptic_device.h"
#include "devices/input/deflection_hand.h"
#include "devices/input/reopener.h"
#include "devices/spacemouse/spnav_socket.h"
#include "devices/spacemouse/spnav_stream.h"

namespace handrail {

struct SpaceMouseOptions {
  std::string socket;  // of spacenavd; empty: see spnav_socket_path
  DeflectionSettings motion;
  // What spacenavd gives at full deflection, with a sensitivity of 1, > 0. From memory of such
  // devices, whose data sheets do not say it.
  double full_counts = 350.0;
  // A motion counts for so long; then the cap has been let go of unseen, > 0. As long as a cursor's
  // (kCursorPatience).
  Nanos patience = kCursorPatience;
  // Numbers as spacenavd has them, from 0. The third: without one there is no dead-man.
  int clutch_button = 0;
  int drop_button = 1;
  std::optional<int> enable_button;
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
};

// Through spacenavd, so that other programs may have the device as well. Makes no force. The cap's
// axes are those of M: right, up, toward the user; turns are about the same. Velocity: the place
// stays where the cap is let go of, within the work space, and goes to its middle while the clutch
// button is held. Position: the hand is where the cap is pushed to.
//
// Unplugged, or without spacenavd, readings are invalid; when it is there again the hand goes on
// where it was. A daemon of protocol 0 (before 1.0) does not tell of unplugging: then the hand
// rests.
class SpaceMouseDevice final : public HapticDevice {
 public:
  explicit SpaceMouseDevice(const SpaceMouseOptions& options);
  ~SpaceMouseDevice() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // The error says why spacenavd cannot be reached, and what to do.
  Status open() override;
  // Not valid while closed or unplugged. Takes at most 128 events; more wait for the next.
  HapticSample read(Nanos now) noexcept override;
  DeviceTrouble trouble() const noexcept override;
  void write(const Wrench&) noexcept override {}
  void close() noexcept override;

  // Of the connection that there is: how many motions spacenavd told so far.
  std::uint64_t motions() const noexcept { return stream_.state().motions; }

 private:
  void receive(Nanos now) noexcept;
  void lose() noexcept;
  void show(bool there) noexcept;
  std::uint32_t buttons() const noexcept;
  Deflection deflection(Nanos now) const noexcept;

  SpaceMouseOptions options_;
  HapticCapabilities capabilities_;
  Reopener<SpnavConnection> reopener_;
  SpnavStream stream_;
  DeflectionHand hand_;
  HapticSample sample_;
  int fd_ = -1;  // -1: not connected
  Nanos last_ = 0;
  Nanos moved_at_ = -kForever;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
