#include "client/cli/devices/devices_run.h"

#include <filesystem>
#include <ostream>

#include "devices/config/device_config_io.h"
#include "devices/udp/udp_table.h"
#include "proto/devices.pb.h"
#include "server/base/clock.h"
#include "server/base/output.h"
#include "server/base/pacer.h"
#include "server/base/plain_text.h"
#include "server/scene/config_io.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

const char* readiness_text(Readiness r) {
  return r == Readiness::kReady ? "ready" : r == Readiness::kUnfinished ? "UNFINISHED" : "absent";
}

const char* verdict_text(Verdict v) {
  return v == Verdict::kOk ? "ok" : v == Verdict::kBad ? "BAD" : "NOT SEEN";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text + "  ";
}

pb::DeviceList look_everywhere(const DeviceSettings& settings) {
  pb::DeviceList out;
  for (const DriverRow& row : driver_rows()) {
    const auto driver = row.make(settings);
    for (const Sighting& seen : driver->probe()) {
      pb::DeviceRow* one = out.add_devices();
      one->set_name(row.name);
      one->set_what(driver->what());
      one->set_simulated(row.simulated);
      one->set_place(seen.place);
      one->set_readiness(static_cast<pb::DeviceRow::Readiness>(seen.readiness));
      one->set_fact(seen.fact);
      one->set_next(seen.next);
    }
  }
  return out;
}

std::string list_text(const pb::DeviceList& list) {
  std::size_t width = 0;
  for (const std::string& name : driver_names()) width = std::max(width, name.size());
  std::string out;
  for (const pb::DeviceRow& row : list.devices()) {
    out += padded(row.name(), width) +
           padded(readiness_text(static_cast<Readiness>(row.readiness())), 10) +
           (row.place().empty() ? "" : row.place() + ": ") + row.fact() + '\n';
    if (!row.next().empty()) out += std::string(width + 14, ' ') + "-> " + row.next() + '\n';
  }
  return out;
}

pb::DeviceTestReport report_of(const DriverRow& row, const Driver& driver, const SelfTest& test,
                               bool broken_off) {
  pb::DeviceTestReport out;
  out.set_name(row.name);
  bool passed = !broken_off;
  for (const TestItem& item : test.items()) {
    pb::DeviceTestItem* one = out.add_items();
    one->set_check(item.check);
    one->set_verdict(static_cast<pb::DeviceTestItem::Verdict>(item.verdict));
    one->set_fact(item.fact);
    one->set_next(item.next);
    passed = passed && item.verdict == Verdict::kOk;
  }
  out.set_passed(passed);
  out.set_broken_off(broken_off);
  out.set_block(test.block());
  out.set_daemon(driver.daemon());
  return out;
}

std::string report_text(const pb::DeviceTestReport& report) {
  std::size_t width = 0;
  for (const auto& item : report.items()) width = std::max(width, item.check().size());
  std::string out;
  for (const auto& item : report.items()) {
    out += padded(verdict_text(static_cast<Verdict>(item.verdict())), 8) +
           padded(item.check(), width) + item.fact() + '\n';
    if (!item.next().empty()) out += std::string(width + 12, ' ') + "-> " + item.next() + '\n';
  }
  if (report.broken_off()) out += "broken off\n";
  if (report.block().empty()) return out;
  return out + "for the file of " + report.daemon() + ":\n" + report.block() + '\n';
}

ExitCode fail_with(const DevicesPlace& place, const std::string& text, ExitCode code) {
  place.err << "handrail: " << text << '\n';
  return code;
}

// Turns the test until it has ended or is broken off; says what it asks for.
void run_test(SelfTest& test, const DevicesPlace& place) {
  std::string asked;
  Pacer pacer(std::max<Nanos>(test.period(), kMicrosecond), monotonic_now());
  for (;;) {
    if (const std::string asks = test.asks(); asks != asked) {
      asked = asks;
      if (!asks.empty()) place.err << "-> " << asks << std::endl;
    }
    if (place.interrupted() || !test.turn(monotonic_now())) return;
    if (test.period() == 0) continue;
    sleep_until(pacer.due());
    (void)pacer.woke(monotonic_now());
  }
}

// Where the block goes: a file that is not there yet, so that no configuration is lost.
Status check_new_file(const std::optional<std::string>& path) {
  std::error_code error;
  if (!path || !std::filesystem::exists(*path, error)) return Status::ok();
  return Status::error("--out: " + *path + " is there already, expected a new file");
}

}  // namespace

Result<DeviceSettings> device_settings(const DevicesWords& words) {
  const auto master = load_master_config(words.master_config, "", "");
  if (!master) return master.status();
  const auto slave = load_slave_config(words.slave_config, "");
  if (!slave) return slave.status();
  DeviceSettings out;
  out.hand = haptic_options(master->device());
  if (const auto stop = switch_options(*slave)) out.stop_switch = *stop;
  if (!words.device.empty()) out.stop_switch = {words.device, std::nullopt};
  out.robot = robot_options(slave->robot());
  out.sensor = sensor_options(slave->force_sensor());
  out.card_sensor = comedi_sensor_options(slave->force_sensor());
  out.has_sensor = slave->force_sensor().enabled();
  out.sensor_at_card = slave->force_sensor().has_comedi();
  const pb::FtConfig& handle = master->handle_sensor().sensor();
  out.handle = sensor_options(handle);
  out.card_handle = comedi_sensor_options(handle);
  out.has_handle = master->handle_sensor().has_sensor() && handle.enabled();
  out.handle_at_card = handle.has_comedi();
  out.handle_taken =
      out.has_handle && udp_speaks_with(kUdpTable, out.handle.address, out.handle.port);
  out.master_given = !words.master_config.empty();
  out.slave_given = !words.slave_config.empty();
  out.robot_taken = udp_speaks_with(kUdpTable, out.robot.address, out.robot.port);
  out.sensor_taken = udp_speaks_with(kUdpTable, out.sensor.address, out.sensor.port);
  return out;
}

std::vector<DeviceFacts> wanted_devices(const DeviceSettings& settings) {
  std::vector<DeviceFacts> out;
  for (const DriverRow& row : driver_rows()) {
    if (row.wanted(settings)) out.push_back({row.name, row.make(settings)->probe()});
  }
  return out;
}

ExitCode list_devices(const DevicesWords& words, const DevicesPlace& place) {
  const auto settings = device_settings(words);
  if (!settings) return fail_with(place, settings.message(), kExitUsage);
  const pb::DeviceList list = look_everywhere(*settings);
  place.out << (words.json ? json_text(list, true) + '\n' : list_text(list));
  return kExitDone;
}

ExitCode test_device(const DevicesWords& words, const DevicesPlace& place) {
  const DriverRow* const row = find_driver(words.name);
  if (row == nullptr) {
    const std::string nearest = nearest_name(words.name, driver_names());
    return fail_with(place,
                     "devices: there is no '" + shown(words.name) + "', " +
                         (nearest.empty() ? "expected " + joined(driver_names(), ", ")
                                          : "did you mean '" + nearest + "'?"),
                     kExitUsage);
  }
  if (!words.device.empty() && words.name != "stop-switch") {
    return fail_with(place, "devices: --device is for stop-switch, not for " + words.name,
                     kExitUsage);
  }
  const auto settings = device_settings(words);
  if (!settings) return fail_with(place, settings.message(), kExitUsage);
  if (const Status s = check_new_file(words.out); !s)
    return fail_with(place, s.message(), kExitUsage);
  const auto driver = row->make(*settings);
  StartedTest test = words.calibrates ? driver->calibrate() : driver->test(words.wishes);
  if (!test) return fail_with(place, test.message(), kExitRefused);
  run_test(**test, place);
  const bool broken_off = place.interrupted();
  const pb::DeviceTestReport report = report_of(*row, *driver, **test, broken_off);
  // Lets go of the device before anybody reads how it went.
  test->reset();
  if (words.out && !broken_off && !report.block().empty()) {
    if (const Status s = write_file(*words.out, report.block() + '\n'); !s) {
      return fail_with(place, s.message(), kExitUsage);
    }
  }
  place.out << (words.json ? json_text(report, true) + '\n' : report_text(report));
  return broken_off ? kExitInterrupted : report.passed() ? kExitDone : kExitRefused;
}

}  // namespace handrail
