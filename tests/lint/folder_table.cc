#include "tests/lint/folder_table.h"

namespace handrail::lint {
namespace {

Folders operator+(Folders a, const Folders& b) {
  a.insert(b.begin(), b.end());
  return a;
}

const Folders kBase = {"server/base"};
const Folders kModel = kBase + Folders{"server/model"};
const Folders kConsole =
    kModel + Folders{"proto", "client/console/gateway", "client/console/scene"};
const Folders kHands = {"devices/hand", "devices/omni", "devices/joystick", "devices/page"};
const Folders kDesk = {"devices/spacemouse", "devices/touch",  "devices/input",
                       "devices/evdev",      "devices/comedi", "devices/force_stick"};
const Folders kDrivers = {"devices/evdev", "devices/melfa", "devices/net_ft"};
const Folders kRigs = {"devices/rig", "devices/rig/world", "devices/melfa", "devices/net_ft"};

// What both sides are made of.
Table part_rows() {
  return {{"proto", {}},
          {"server/base", {}},
          {"server/model", kBase},
          {"server/packets", kBase},
          {"server/keys", kBase},
          {"server/keys/pairing", kBase + Folders{"server/keys"}},
          {"server/daemon", kBase},
          {"server/task", kModel},
          {"server/kinematics", kModel},
          {"server/constraint", kModel},
          {"server/constraint/drawn", kModel + Folders{"server/constraint"}},
          {"server/constraint/painted", kModel + Folders{"server/constraint"}},
          {"server/effects", kModel},
          {"server/session", kModel},
          {"server/stability", kModel},
          {"server/motion", kModel + Folders{"server/kinematics"}},
          {"server/haptic",
           kModel + Folders{"server/session", "server/constraint", "server/constraint/drawn",
                            "server/constraint/painted", "server/effects", "server/stability"}},
          {"server/follow", kModel + Folders{"server/session", "server/constraint",
                                             "server/kinematics", "server/motion"}},
          {"server/painting", kModel},
          {"server/scene/cards", kModel + Folders{"proto"}},
          {"server/scene",
           kModel + Folders{"server/kinematics", "server/painting", "proto", "server/scene/cards"}},
          {"server/link", kModel + Folders{"proto", "server/packets"}},
          {"server/record/mcap", kBase},
          {"server/record",
           kModel + Folders{"server/record/mcap", "server/haptic", "server/follow", "server/link",
                            "server/scene", "server/packets", "devices", "proto"}},
          {"server/link/secure", kModel + Folders{"server/daemon", "server/link", "server/keys"}}};
}

// The daemons, and who drives them.
Table program_rows() {
  const Folders text = kModel + Folders{"proto", "server/scene"};
  const Folders daemons = text + Folders{"server/daemon",      "server/keys",    "server/link",
                                         "server/link/secure", "server/session", "server/record",
                                         "server/packets",     "devices",        "devices/config"};
  const Folders task = text + Folders{"server/task", "client/api"};
  const Folders study = {"devices/hand", "server/lab/study", "server/lab/study/screw"};
  return {
      {"server/master",
       daemons + Folders{"server/haptic", "server/stability", "server/constraint",
                         "server/kinematics", "server/master/handle", "devices/hand"}},
      {"server/master/handle", kModel + Folders{"devices"}},
      {"server/slave", daemons + Folders{"server/follow", "server/kinematics", "devices/melfa",
                                         "devices/net_ft", "devices/evdev", "devices/comedi"}},
      {"client/api", kBase + Folders{"proto", "server/keys", "server/link/secure"}},
      {"client/doctor",
       kModel + Folders{"proto", "server/keys", "server/link", "client/api", "devices"}},
      {"client/experiment",
       task + study +
           Folders{"client/experiment/recording", "client/experiment/screw", "server/lab/walls",
                   "server/lab/study/linear", "server/lab/figure"}},
      {"client/experiment/recording", kBase + Folders{"proto", "client/api"}},
      {"client/experiment/screw", kModel + study + Folders{"proto", "client/api"}},
      {"client/experiment/rehearsal",
       task + Folders{"client/experiment", "server/lab/walls", "server/master", "server/haptic",
                      "devices", "devices/hand", "devices/page"}},
      {"client/cli",
       task + Folders{"server/keys", "server/keys/pairing", "server/link", "server/link/secure",
                      "client/doctor", "client/experiment", "client/experiment/rehearsal",
                      "client/cli/record", "client/cli/devices", "client/cli/robot"}},
      {"client/cli/robot",
       text + Folders{"client/api", "devices", "devices/config", "devices/melfa"}},
      {"client/cli/devices", text + Folders{"client/api", "client/doctor", "devices",
                                            "devices/catalogue", "devices/config", "devices/udp"}},
      {"client/cli/record", kBase + Folders{"server/record", "server/record/mcap"}},
      {"client/console/gateway", kBase + Folders{"proto"}},
      {"client/console/scene", text + Folders{"server/kinematics", "server/constraint/drawn"}},
      {"client/console/viewer", kConsole + Folders{"server/record/mcap"}},
      {"client/console/play",
       kConsole + Folders{"server/kinematics", "server/master", "server/record", "server/scene"}},
      {"client/console",
       kConsole + Folders{"server/daemon", "server/keys", "server/scene", "client/api",
                          "client/console/viewer", "client/console/play"}}};
}

Table lab_rows() {
  const Folders sides = {"server/master", "server/slave", "server/kinematics"};
  const Folders network = kModel + Folders{"server/lab/network"};
  // What a command of the lab is made of.
  const Folders lab =
      network + Folders{"devices",           "proto",          "server/scene", "server/lab/console",
                        "server/lab/figure", "server/lab/cell"};
  return {
      {"server/lab",
       kBase + Folders{"server/lab/accuracy", "server/lab/contact", "server/lab/delay",
                       "server/lab/faults", "server/lab/hand", "server/lab/links",
                       "server/lab/replay", "server/lab/scenes", "server/lab/sequences",
                       "server/lab/stability", "server/lab/study/linear", "server/lab/study/screw",
                       "server/lab/walls"}},
      {"server/lab/console", kBase},
      {"server/lab/figure", kBase},
      {"server/lab/network", kBase},
      {"server/lab/cell",
       network + kRigs + Folders{"server/haptic", "server/follow", "server/link", "server/record"}},
      {"server/lab/study",
       lab + kHands + sides +
           Folders{"devices/rig", "server/haptic", "server/lab/replay", "server/record"}},
      {"server/lab/study/linear", lab + Folders{"server/lab/study", "server/task"}},
      {"server/lab/study/screw", lab + kHands + kRigs + Folders{"server/lab/study", "server/task"}},
      {"server/lab/hand", lab + kHands + sides},
      {"server/lab/replay",
       lab + sides +
           Folders{"server/haptic", "server/follow", "server/record", "server/record/mcap"}},
      {"server/lab/scenes", lab + kHands + kRigs +
                                Folders{"server/master", "server/haptic", "server/kinematics",
                                        "server/constraint/drawn", "server/stability"}},
      {"server/lab/accuracy", lab + kHands +
                                  Folders{"server/lab/scenes", "server/master", "server/haptic",
                                          "server/constraint", "server/link"}},
      {"server/lab/walls", lab + kHands +
                               Folders{"server/lab/study", "server/master", "server/haptic",
                                       "server/constraint", "server/constraint/drawn"}},
      {"server/lab/stability",
       lab + kHands + sides +
           Folders{"server/lab/sequences", "server/lab/faults/audit", "server/lab/study",
                   "server/haptic", "server/stability"}},
      {"server/lab/contact", lab + Folders{"server/lab/study", "server/follow"}},
      {"server/lab/delay", lab + kHands + kRigs + sides +
                               Folders{"server/lab/study", "server/haptic", "server/follow"}},
      {"server/lab/links",
       lab + Folders{"server/lab/faults", "server/lab/study", "server/session"}},
      {"server/lab/sequences", lab + Folders{"devices/omni", "server/master", "server/haptic",
                                             "server/lab/faults", "server/lab/study"}},
      {"server/lab/faults/audit", network + Folders{"server/motion", "server/kinematics"}},
      {"server/lab/faults",
       lab + kHands + sides +
           Folders{"server/lab/faults/audit", "server/lab/study", "server/lab/replay",
                   "server/record", "server/motion", "server/kinematics"}}};
}

Table device_rows() {
  const Folders sim = kModel + Folders{"devices", "devices/hand"};
  return {{"devices", kModel + kHands + kDesk},
          {"devices/self_test", kModel + Folders{"devices"}},
          {"devices/input", kModel + Folders{"devices"}},
          {"devices/spacemouse", kModel + Folders{"devices", "devices/input", "devices/self_test"}},
          {"devices/touch",
           kModel + Folders{"devices", "devices/input", "devices/omni", "devices/self_test"}},
          {"devices/evdev", kBase + Folders{"devices", "devices/input", "devices/self_test"}},
          {"devices/force_stick", kModel + Folders{"devices", "devices/evdev", "devices/input",
                                                   "devices/joystick", "devices/self_test"}},
          {"devices/udp", kBase + Folders{"server/packets"}},
          {"devices/melfa",
           kModel + Folders{"devices", "devices/udp", "devices/self_test", "server/packets"}},
          {"devices/comedi",
           kModel + Folders{"devices", "devices/input", "devices/joystick", "devices/self_test"}},
          {"devices/net_ft",
           kBase + Folders{"devices", "devices/udp", "devices/self_test", "server/packets"}},
          {"devices/catalogue",
           kModel + kHands + kDesk + kDrivers + Folders{"devices", "devices/self_test"}},
          {"devices/config", kModel + kDesk + kDrivers +
                                 Folders{"devices", "devices/hand", "devices/joystick", "proto"}},
          {"devices/hand", sim},
          {"devices/omni", sim},
          {"devices/joystick", sim},
          {"devices/page", sim + Folders{"devices/joystick"}},
          {"devices/rig/world", kModel + Folders{"server/kinematics"}},
          {"devices/rig", kModel + kRigs +
                              Folders{"proto", "server/daemon", "server/kinematics", "server/link",
                                      "server/scene", "devices/udp"}}};
}

}  // namespace

const Table& folder_table() {
  static const Table rows = [] {
    Table all;
    for (const Table& part : {part_rows(), program_rows(), lab_rows(), device_rows()}) {
      all.insert(part.begin(), part.end());
    }
    return all;
  }();
  return rows;
}

}  // namespace handrail::lint
