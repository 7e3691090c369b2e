// What is done at a controller's own switches, one order after the other. Without sockets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/melfa/r3_protocol.h"
#include "server/base/time.h"
#include "server/model/reason.h"

namespace handrail {

// The way to a controller: one order, one answer.
class R3Line {
 public:
  virtual ~R3Line() = default;
  // Waits for the answer, bounded. The error names the order and the cause, and after a "; " what
  // to do; a refusal is an answer.
  virtual Result<R3Answer> ask(const std::string& order) = 0;
  // Waits for so long.
  virtual void pause(Nanos time) = 0;
  // Somebody wants an end: what was begun is undone.
  virtual bool interrupted() const = 0;
  // From here on ask() does not heed that.
  virtual void finish() = 0;
};

// What is wrong, and what to do about it.
struct Obstacle {
  std::string fact;               // empty: nothing
  std::string next;               // empty: nothing is known
  bool refused = false;           // by the controller in so many words; else it may have been done
  Reason reason = Reason::kNone;  // of those that begin with kRobot, where one says it
  bool none() const { return fact.empty(); }
};

// Of an error's text, "fact; next".
Obstacle obstacle_in(const std::string& error);

struct SwitchWishes {
  std::string program;                  // that opens MXT; empty: none is to be started
  std::optional<int> override_percent;  // that is to be set, 1 to 100; none: 100 is expected
};

struct SwitchesReport {
  std::optional<R3State> before, after;  // none: the controller did not say
  std::string alarm_text;                // of the alarm of `before`, as the controller words it
  std::vector<std::string> steps;        // what was done, in order
  bool done = false;
  Obstacle problem;
};

// What else is to be known of an override below 100 %.
extern const char kSlowOverride[];

// What keeps real-time control from working, the first of what there is: emergency stop, alarm,
// teaching mode, machine lock, another program, override, servos, program. `alarm_text` may be
// empty.
Obstacle obstacle_of(const R3State& state, const SwitchWishes& wishes,
                     const std::string& alarm_text);

// Why a controller that does not answer real-time control is silent: as obstacle_of(), but that an
// override is named last, as it makes none silent; or why its switches cannot be asked; or, where
// they are as they should be, that. Never none(). Changes nothing.
Obstacle silence_of(R3Line& line, const std::string& program);

// Looks, and changes nothing. Done: the controller told; `problem` then is obstacle_of().
SwitchesReport look_at_switches(R3Line& line, const SwitchWishes& wishes);

// Brings the controller to where real-time control can begin: takes the right to operate it, sets
// the override that is wished for, switches the servos on, starts the program, gives the right
// back. Moves nothing by itself: what stands in the program before MXT the arm does. Begins nothing
// while there is an obstacle that it cannot take away. What it began and could not end it takes
// back: the program is stopped and the servos are off again, unless they were on before.
SwitchesReport switch_on(R3Line& line, const SwitchWishes& wishes);

// Stops the program and switches the servos off, whatever else is refused or not understood. Heeds
// no interruption. Done: the controller says that they are off.
SwitchesReport switch_off(R3Line& line);

// Resets the alarm. Done: none stands any more.
SwitchesReport reset_alarm(R3Line& line);

}  // namespace handrail
