// Every kind of device there is a driver for.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/comedi/ft_source.h"
#include "devices/driver.h"
#include "devices/evdev/stop_switch_driver.h"
#include "devices/input/usb_scan.h"
#include "devices/melfa/melfa_robot.h"
#include "devices/net_ft/net_ft_sensor.h"
#include "devices/registry.h"

namespace handrail {

// What drivers are told: the daemons' configurations, and where on this computer to look.
struct DeviceSettings {
  HapticDeviceOptions hand;
  StopSwitchOptions stop_switch;  // without a path: none is configured
  MelfaOptions robot;
  NetFtOptions sensor;
  ComediFtOptions card_sensor;
  bool has_sensor = true;       // the slave's file wants one
  bool sensor_at_card = false;  // and it is `card_sensor`
  NetFtOptions handle;
  ComediFtOptions card_handle;
  bool has_handle = false;      // the master's file wants a real sensor on the handle
  bool handle_at_card = false;  // and it is `card_handle`
  bool handle_taken = false;
  bool master_given = false, slave_given = false;  // files, and not their defaults
  // A program of this computer speaks with it already: it is left alone.
  bool robot_taken = false, sensor_taken = false;
  std::string input_folder = kInputFolder;
  std::string usb_folder = kUsbFolder;
};

// A row of the catalogue: adding a driver adds one.
struct DriverRow {
  const char* name;  // as it is typed
  bool simulated;
  std::unique_ptr<Driver> (*make)(const DeviceSettings& settings);
  // Whether the files that were given want it.
  bool (*wanted)(const DeviceSettings& settings);
};

std::span<const DriverRow> driver_rows();

// Null: no driver is called so.
const DriverRow* find_driver(const std::string& name);
std::vector<std::string> driver_names();

}  // namespace handrail
