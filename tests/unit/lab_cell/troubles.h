// What may befall both sides, for tests of the way out of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/unit/lab_cell/two_sides.h"

namespace handrail {

using Deed = std::function<void(TwoSides&)>;

struct Trouble {
  const char* name;
  Deed comes;
  Presence presence = Presence::kNone;
  const char* scene = TwoSides::kArm;
};

using Troubles = std::vector<Trouble>;

// Nothing, and what an operator orders.
inline Troubles orders_given() {
  const auto order = [](const char* text) { return [text](TwoSides& t) { t.ask(text); }; };
  return {
      {"nothing", [](TwoSides&) {}},
      {"disengaged", order("disengage: true")},
      {"clutched", order("clutch: true")},
      {"stopped", order("stop: true")},
  };
}

// Of the controller, the arm and its sensor.
inline Troubles arm_troubles() {
  const auto arm = [](ScriptedArm::State state, Nanos span) {
    return [state, span](TwoSides& t) {
      t.arm.state = state;
      t.run(span);
    };
  };
  return {
      {"controller silent", arm(ScriptedArm::State::kAway, kSecond / 2)},
      {"controller lost", arm(ScriptedArm::State::kAway, 3 * kSecond)},
      {"controller answers zeros", arm(ScriptedArm::State::kZeros, kSecond)},
      {"controller away, slave started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(3 * kSecond);
       }},
      {"controller answers zeros, slave started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kZeros;
         t.start_slave();
         t.run(3 * kSecond);
       }},
      {"sensor not sound",
       [](TwoSides& t) {
         t.sensor = false;
         t.run(kSecond);
       }},
  };
}

// Of the network, and of both programs.
inline Troubles program_troubles() {
  return {
      {"network cut for 0.1 s",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(kSecond / 10);
         t.cut_network(false);
       }},
      {"network cut",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(2 * kSecond);
       }},
      {"slave ended",
       [](TwoSides& t) {
         t.end_slave();
         t.run(2 * kSecond);
       }},
      {"slave started anew",
       [](TwoSides& t) {
         t.start_slave();
         t.run(kSecond);
       }},
      {"slave in fault, then started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kZeros;
         t.run(kSecond);
         t.arm.state = ScriptedArm::State::kThere;
         t.start_slave();
         t.run(kSecond);
       }},
      {"master started anew",
       [](TwoSides& t) {
         t.start_master();
         t.run(kSecond);
       }},
      {"haptic loop stands still",
       [](TwoSides& t) {
         t.master_stalls = true;
         t.run(kSecond);
       }},
      {"haptic loop stood still",
       [](TwoSides& t) {
         t.master_stalls = true;
         t.run(kSecond);
         t.master_stalls = false;
         t.run(kSecond);
       }},
  };
}

// Of who drives, and with what.
inline Troubles drive_troubles() {
  return {
      {"device not valid",
       [](TwoSides& t) {
         t.device.sample.valid = false;
         t.run(kSecond);
       }},
      {"scene differs",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         t.give_slave_the_scene(false);
         t.run(kSecond);
       }},
      {"another master leads",
       [](TwoSides& t) {
         t.other_master = true;
         t.run(kSecond);
       }},
      {"lease lost",
       [](TwoSides& t) {
         t.ask("lease { act: RELEASE }");
         t.run(kSecond / 10);
         t.who = "ben";
       }},
  };
}

// Nobody holds on.
inline Troubles presence_troubles() {
  return {
      {"nobody holds on",
       [](TwoSides& t) {
         t.holds = false;
         t.run(kSecond);
       },
       Presence::kHold},
      {"nobody held on",
       [](TwoSides& t) {
         t.holds = false;
         t.run(4 * kSecond);
       },
       Presence::kHold},
      {"button not held",
       [](TwoSides& t) {
         t.device.sample.buttons = 0;
         t.run(kSecond);
       },
       Presence::kButton},
      {"button not held for long",
       [](TwoSides& t) {
         t.device.sample.buttons = 0;
         t.run(4 * kSecond);
       },
       Presence::kButton},
  };
}

// A scene without an arm.
inline Troubles wall_troubles() {
  return {
      {"walls", [](TwoSides&) {}, Presence::kNone, TwoSides::kWalls},
      {"walls loaded in an arm's place",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         EXPECT_TRUE(t.done(std::string("scene_load: '") + TwoSides::kWalls + "'"));
         t.run(2 * kSecond);
       }},
      {"walls loaded in a fault",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(kSecond);
         t.cut_network(false);
         EXPECT_TRUE(t.done(std::string("scene_load: '") + TwoSides::kWalls + "'"));
         t.run(2 * kSecond);
       }},
  };
}

// An engage that waits.
inline Troubles waiting_troubles() {
  return {
      {"homing: engage waits for a controller that is away",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(2 * kSecond);
         t.begin("engage: true");
         t.run(kSecond);
       }},
      {"homing: engage has waited for a controller that is away",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(2 * kSecond);
         t.ask("engage: true");
       }},
      {"aligning: the slave does not hear of it",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         t.begin("engage: true");
         t.cut_way_to_slave(true);
         t.run(kSecond);
         t.cut_way_to_slave(false);
       }},
  };
}

// From a cell in which nothing was done yet, or one that is led; and what may come on top.
inline Troubles troubles() {
  Troubles all;
  for (const Troubles& some : {orders_given(), arm_troubles(), program_troubles(), drive_troubles(),
                               presence_troubles(), wall_troubles(), waiting_troubles()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace handrail
