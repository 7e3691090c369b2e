// A stand-in for the robot controller that plays a script of exact packets on a free loopback port.
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/mxt/mxt_golden.h"

namespace handrail::test {

// Write the script, then play(). The test fails when a packet differs from the one expected, when
// the script does not come to its end, or when a packet is left unread behind it.
class ScriptedMxtPeer {
 public:
  ScriptedMxtPeer();
  ~ScriptedMxtPeer();  // finish()

  std::uint16_t port() const { return port_; }

  // The next packet must be these bytes.
  ScriptedMxtPeer& expect(golden::Packet bytes);
  // Sends these bytes to whoever sent the last packet.
  ScriptedMxtPeer& reply(golden::Packet bytes);
  // From here on takes and forgets whatever comes, until finish(). Last in a script.
  ScriptedMxtPeer& ignore_the_rest();

  // Starts playing on a thread of its own.
  void play();
  // Waits for the script's end and reports. Safe to call twice.
  void finish();

 private:
  enum class Kind { kExpect, kReply, kIgnore };
  struct Step {
    Kind kind;
    golden::Packet bytes;
  };
  void run();
  void fail(std::size_t step, const std::string& what);

  int socket_ = -1;
  std::uint16_t port_ = 0;
  std::vector<Step> script_;
  std::vector<std::string> failures_;
  std::thread thread_;
  bool played_ = false;
  bool finished_ = false;
};

}  // namespace handrail::test
