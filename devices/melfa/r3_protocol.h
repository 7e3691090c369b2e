// The R3 protocol: the lines of text by which a MELFA controller is asked and told things beside
// the real-time control, TCP port 10001. Without sockets.
//
// An order is "1;1;STATE"; its answer begins with QoK, or with QeR and an error's number. The third
// letter is small while an alarm stands: Qok, Qer. Over TCP nothing ends an answer; over a serial
// line, and where a controller is set up so, a CR does. Sources: roboticslibrary/rl
// src/rl/hal/MitsubishiR3.cpp and .h; for the small letters and the CR the driver of a serial MELFA
// by arm_control; for an RV-2A's answer npapnet/hmu.melfa_robot.py
// matlab/.../MELFA_COMMANDS/GETSTATE.m.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/status.h"

namespace handrail {

// The longest answer we take. Public clients read into 256 to 1024 bytes at once. [bytes]
inline constexpr std::size_t kMostR3Answer = 1024;

// Puts an answer together from its pieces.
class R3Reader {
 public:
  enum class Said : std::uint8_t {
    kMore,     // may go on: silence ends it
    kWhole,    // a CR or LF has ended it
    kTooLong,  // kMostR3Answer bytes and no end
  };
  Said take(std::string_view piece);
  // What came, its end included.
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool ended_ = false;
};

struct R3Answer {
  bool done = false;   // QoK; else it was refused
  bool alarm = false;  // the letter is small: an alarm stands
  int error = 0;       // number of the refusal; 0: none was given
  std::string body;    // what follows QoK; plain text or bytes of the controller's language
};

// The error says what came and what was expected.
Result<R3Answer> parse_r3_answer(std::string_view text);

// How the controller is, as two bytes in hexadecimal tell. The public driver of rl reads the second
// byte of DSTATE from the digits of the first one; STATE's it reads from its own, as is done here.
struct R3Status {
  std::uint8_t run = 0;   // RunSts in MitsubishiR3.h
  std::uint8_t stop = 0;  // StopSts there
  int alarm = 0;          // number; 0: none

  bool machine_lock() const { return (run & 0x04) != 0; }  // programs run and the arm stands
  bool teach() const { return (run & 0x08) != 0; }         // else automatic
  bool servo_on() const { return (run & 0x20) != 0; }
  bool running() const { return (run & 0x40) != 0; }
  bool rights_taken() const { return (run & 0x80) != 0; }  // somebody may operate it
  bool emergency_stop() const { return (stop & 0x01) != 0; }
};

struct R3State {
  R3Status status;
  std::string program;       // loaded into the first slot; empty: none
  int line = 0;              // of the program
  int override_percent = 0;  // of the speed
};

// The body of an answer to DSTATE, "A1060;1;0": run, stop and alarm; step; mechanism. The errors
// name the field and what was expected.
Result<R3Status> parse_r3_dstate(std::string_view body);
// The same of STATE, "1;20;100;0;E1000;2;1;...": program; line; override; edit; run, stop and
// alarm; step; mechanisms; and more that is not looked at.
Result<R3State> parse_r3_state(std::string_view body);

// Whether `told` is the program `wanted`: letters large or small, and without an ending such as
// ".MB4".
bool same_program(std::string_view wanted, std::string_view told);

}  // namespace handrail
