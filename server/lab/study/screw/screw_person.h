// What a simulated operator does to fasten a screw, wherever the cell is: in virtual time or at the
// running programs. Simulated: results obtained with it must be labelled so.
#pragma once

#include <initializer_list>

#include "devices/hand/operator_model.h"
#include "devices/rig/world/compliance.h"
#include "server/lab/study/screw/screw_judge.h"
#include "server/model/tool_call.h"

namespace handrail {

// A key that the operator presses.
struct ScrewKey {
  enum class Act : std::uint8_t { kNone, kTool, kToolsOff };
  Act act = Act::kNone;
  ToolCall tool;  // kTool
};

// The cell, as the operator has it.
class ScrewPlace {
 public:
  virtual ~ScrewPlace() = default;

  // Lets a moment pass, with a key pressed in it. False: the trial has ended.
  virtual bool pass(const ScrewKey& key) = 0;
  // The first decision is made: the clock starts, and the clutch is let go.
  virtual void start_clock() = 0;
  virtual double now() const = 0;  // [s]
  virtual OperatorModel& mind() = 0;
  virtual void leave_off() = 0;
  virtual Pose tip() const = 0;          // X_ST, true
  virtual Pose told_tip() const = 0;     // as the arm measures it
  virtual Vec3 told_force() const = 0;   // of the contact, frame S [N]
  virtual double off_flats() const = 0;  // by how much the key is turned off the flats [rad]
  virtual bool tight() const = 0;
};

struct ScrewHabits {
  bool tools = false;
  double pause = 0.0;  // for a decision [s]
  double tick = 1e-3;  // what pass() lets pass [s]
};

// Until the screw is tight it inserts the ball end, turns clockwise about half a turn, lifts the
// key and turns back. With tools: a line along the screw's axis throughout, with N-rotation while
// inserting and F-rotation while turning, lifting and turning back.
class ScrewPerson {
 public:
  // `place` and `person` must outlive it; `give` bends the key that the line is laid along. The key
  // waits beside and above the socket now.
  ScrewPerson(ScrewPlace& place, const ScrewWork& work, const Compliance& give,
              const OperatorParameters& person, const ScrewHabits& habits);

  // Returns when the trial has ended.
  void fasten();
  ScrewPhase phase() const { return phase_; }
  int misses() const { return misses_; }  // insertions that had to be tried again

 private:
  bool wait(double seconds);
  bool step(const ScrewKey& key = {}) { return place_.pass(key); }
  bool decide() { return wait(habits_.pause); }
  bool start_clock();
  bool call(std::initializer_list<ScrewKey> keys);
  bool act(ScrewPhase phase, OperatorAim aim, bool until_in = false);
  Quat turned(double angle) const;
  double fitting() const;
  bool align();
  bool let_down();
  OperatorAim by_hand(double up) const;
  bool push_on();
  bool seems_in() const;
  bool insert();
  bool seek();
  bool give_up();
  bool turn();
  bool lift();
  bool turn_back();

  ScrewPlace& place_;
  ScrewWork work_;
  Compliance give_;
  const OperatorParameters& person_;
  ScrewHabits habits_;
  Quat q_start_;
  ScrewPhase phase_ = ScrewPhase::kAlign;
  int misses_ = 0;
  bool at_keys_ = false;
  bool on_line_ = false;       // a line is called
  bool line_found_ = false;    // with tools: the line stands over the socket
  bool free_to_turn_ = false;  // F-rotation has been called already
  bool inserted_before_ = false;
  double fit_ = 0.0;          // the key's turn that fits, as last looked at [rad]
  double known_depth_ = 0.0;  // of the hand when the key was in, along `out` [m]
  bool timed_ = false;
};

}  // namespace handrail
