// The simulated controller's own switches, as its R3 channel shows and turns them. Without sockets.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "devices/rig/controller.h"

namespace handrail {

struct SwitchesOptions {
  bool on = true;  // servos on, and the program runs
  bool teach = false;
  int override_percent = 100;  // 1 to 100; slows nothing
  std::string program = "1";   // the one that opens MXT, and the only one there is
  bool rights_taken = false;   // by somebody who is not on this channel
  bool emergency_stop = false;
};

// What a controller is known to say, and no more: STATE, DSTATE, CNTLON, CNTLOFF, SRVON, SRVOFF,
// SLOTINIT, RUN, STOP, RSTALRM, ERRORMES, OVRD, OPEN and CLOSE. The numbers of its errors are its
// own, from 9200 on, where a MELFA has those that its user makes up. The servos take 200 ms to come
// on. One peer has the right to operate it; it has it no more when it is gone. An alarm stops the
// program; reset by RSTALRM it stays stopped. While servos or program are off real-time control is
// not answered.
class Switches {
 public:
  explicit Switches(const SwitchesOptions& options);

  // The answer to one order, without an end.
  std::string answer(std::string_view order, PeerId peer, Nanos now, Controller& controller);
  // The peer's connection has ended.
  void left(PeerId peer) noexcept;
  // Has the controller serve, or not. Before a cycle, and after an order. Real-time safe.
  void update(Nanos now, Controller& controller) noexcept;

  static constexpr Nanos kServoRise = 200 * kMillisecond;

 private:
  bool servo_on(Nanos now) const noexcept { return servo_at_ && now >= *servo_at_; }
  std::string carried_out(std::string_view order, PeerId peer, Nanos now, Controller& controller);
  std::string with_right(std::string_view order, PeerId peer, Nanos now);
  std::string status(Nanos now) const;

  SwitchesOptions options_;
  std::optional<Nanos> servo_at_;  // when the servos are on; none: they are off
  bool running_;
  std::optional<PeerId> right_;  // who may operate it
  int alarm_ = 0;
};

}  // namespace handrail
