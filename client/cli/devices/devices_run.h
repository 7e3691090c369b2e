// What `handrail devices` does: looks for devices, tests one, finds out what is to be configured.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/api/operator_client.h"
#include "client/doctor/facts.h"
#include "devices/catalogue/catalogue.h"
#include "server/base/status.h"

namespace handrail {

// What was typed.
struct DevicesWords {
  std::string name;                         // of a driver
  std::string master_config, slave_config;  // files; empty: their defaults
  std::string device;                       // a stop switch to look at; empty: the configured one
  std::optional<std::string> out;           // new file for the block
  TestWishes wishes;
  bool calibrates = false;  // else tests
  bool json = false;
};

struct DevicesPlace {
  std::ostream& out;
  std::ostream& err;
  bool (*interrupted)();
};

// What drivers are told by the two files. The error names the file, the field and what was
// expected.
Result<DeviceSettings> device_settings(const DevicesWords& words);

// What doctor is told of the devices that the given files name. Nothing where none was given.
std::vector<DeviceFacts> wanted_devices(const DeviceSettings& settings);

// A row for each place where a driver looked. kExitDone whatever is there; kExitUsage for a wrong
// file.
ExitCode list_devices(const DevicesWords& words, const DevicesPlace& place);

// kExitDone: all was seen and as it should be; kExitRefused: not all, or the device cannot be
// opened; kExitInterrupted: broken off, and said how far it had come.
ExitCode test_device(const DevicesWords& words, const DevicesPlace& place);

}  // namespace handrail
