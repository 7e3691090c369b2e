#include "devices/catalogue/catalogue.h"

#include "devices/catalogue/simulated_driver.h"
#include "devices/comedi/comedi_ft_driver.h"
#include "devices/comedi/comedi_joystick_driver.h"
#include "devices/evdev/gamepad_driver.h"
#include "devices/force_stick/force_stick_driver.h"
#include "devices/melfa/melfa_driver.h"
#include "devices/net_ft/net_ft_driver.h"
#include "devices/spacemouse/spacemouse_driver.h"
#include "devices/touch/touch_driver.h"

namespace handrail {
namespace {

using Settings = DeviceSettings;

// With the hand of the configuration where that is of this kind, else with the usual one.
template <HapticDeviceKind kKind>
HapticDeviceOptions simulated_of(const Settings& s) {
  if (s.hand.kind == kKind) return s.hand;
  HapticDeviceOptions out;
  out.kind = kKind;
  out.hand = usual_hand(kKind, out.hand.seed);
  return out;
}

template <HapticDeviceKind kKind>
std::unique_ptr<Driver> simulated(const Settings& s, const char* kind, const char* what) {
  return std::make_unique<SimulatedDriver>(simulated_of<kKind>(s), kind, what);
}

template <HapticDeviceKind kKind>
bool hand_is(const Settings& s) {
  return s.master_given && s.hand.kind == kKind;
}

using Made = std::unique_ptr<Driver>;
using Kind = HapticDeviceKind;

constexpr DriverRow kDrivers[] = {
    {"spacemouse", false,
     [](const Settings& s) -> Made {
       return std::make_unique<SpaceMouseDriver>(s.hand.spacemouse, s.usb_folder);
     },
     hand_is<Kind::kSpaceMouse>},
    {"touch", false,
     [](const Settings& s) -> Made {
       return std::make_unique<TouchDriver>(s.hand.touch, s.usb_folder);
     },
     hand_is<Kind::kTouch>},
    {"gamepad", false,
     [](const Settings& s) -> Made {
       GamepadOptions options = s.hand.gamepad;
       options.input_folder = s.input_folder;
       return std::make_unique<GamepadDriver>(options);
     },
     hand_is<Kind::kGamepad>},
    {"joystick", false,
     [](const Settings& s) -> Made {
       return std::make_unique<ComediJoystickDriver>(s.hand.joystick);
     },
     hand_is<Kind::kJoystick>},
    {"force-stick", false,
     [](const Settings& s) -> Made {
       ForceStickOptions options = s.hand.force_stick;
       options.input_folder = s.input_folder;
       return std::make_unique<ForceStickDriver>(options);
     },
     hand_is<Kind::kForceStick>},
    {"stop-switch", false,
     [](const Settings& s) -> Made {
       return std::make_unique<StopSwitchDriver>(s.stop_switch, s.input_folder);
     },
     [](const Settings& s) { return s.slave_given && !s.stop_switch.path.empty(); }},
    {"melfa", false,
     [](const Settings& s) -> Made {
       return std::make_unique<MelfaDriver>(s.robot, s.robot_taken);
     },
     [](const Settings& s) { return s.slave_given; }},
    {"net-ft", false,
     [](const Settings& s) -> Made {
       return std::make_unique<NetFtDriver>(s.sensor, s.sensor_taken);
     },
     [](const Settings& s) { return s.slave_given && s.has_sensor && !s.sensor_at_card; }},
    {"comedi-ft", false,
     [](const Settings& s) -> Made { return std::make_unique<ComediFtDriver>(s.card_sensor); },
     [](const Settings& s) { return s.slave_given && s.has_sensor && s.sensor_at_card; }},
    {"handle-ft", false,
     [](const Settings& s) -> Made {
       if (s.has_handle && s.handle_at_card) {
         return std::make_unique<ComediFtDriver>(s.card_handle, handle_role());
       }
       NetFtOptions options = s.handle;
       if (!s.has_handle) options.address.clear();
       return std::make_unique<NetFtDriver>(options, s.handle_taken, handle_role());
     },
     [](const Settings& s) { return s.master_given && s.has_handle; }},
    {"sim-omni", true,
     [](const Settings& s) {
       return simulated<Kind::kSimOmni>(s, "SIM_OMNI", "simulated Phantom Omni");
     },
     hand_is<Kind::kSimOmni>},
    {"sim-omni-torque", true,
     [](const Settings& s) {
       return simulated<Kind::kSimOmniTorque>(s, "SIM_OMNI_TORQUE",
                                              "simulated Phantom Omni with torque");
     },
     hand_is<Kind::kSimOmniTorque>},
    {"sim-joystick", true,
     [](const Settings& s) {
       return simulated<Kind::kSimJoystick>(s, "SIM_JOYSTICK", "simulated 2-DOF joystick");
     },
     hand_is<Kind::kSimJoystick>},
    {"page", true,
     [](const Settings& s) {
       return simulated<Kind::kPage>(s, "PAGE", "cursor of a page of handrail-console, simulated");
     },
     hand_is<Kind::kPage>},
    {"recorded", true,
     [](const Settings& s) {
       return simulated<Kind::kRecorded>(s, "RECORDED", "recorded motion from a CSV file");
     },
     hand_is<Kind::kRecorded>},
};

}  // namespace

std::span<const DriverRow> driver_rows() { return kDrivers; }

const DriverRow* find_driver(const std::string& name) {
  for (const DriverRow& row : kDrivers) {
    if (name == row.name) return &row;
  }
  return nullptr;
}

std::vector<std::string> driver_names() {
  std::vector<std::string> out;
  for (const DriverRow& row : kDrivers) out.emplace_back(row.name);
  return out;
}

}  // namespace handrail
