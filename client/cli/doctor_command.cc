#include "client/cli/doctor_command.h"

#include "client/cli/devices/devices_run.h"
#include "client/cli/interrupt.h"
#include "client/cli/robot/robot_run.h"
#include "client/cli/vector_text.h"
#include "client/doctor/gather.h"
#include "client/doctor/judge.h"
#include "client/doctor/report.h"
#include "server/base/realtime.h"
#include "server/base/version.h"
#include "server/keys/key_folder.h"
#include "server/link/codec.h"
#include "server/link/secure/record.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

// As long as an engage looks at the link (good_link_ms).
constexpr double kWatch = 1.0;  // [s]

// Of the encrypted link; none: there is none, or its other end has no address yet.
std::optional<RouteFacts> route_of(const MasterFacts& master) {
  // From a third computer the way is another.
  if (!master.place.host.empty()) return std::nullopt;
  if (!master.status || !master.status->peer().encrypted()) return std::nullopt;
  if (!master.status->peer().has_address()) return std::nullopt;
  return route_facts(master.status->peer().address());
}

// More than any haptic device on the market gives, Force Dimension's sigma.7 and omega.7 included.
constexpr double kMostForce = 40.0;  // [N]

DevicesWords devices_words(const Options& o) {
  DevicesWords out;
  out.name = o.word.value_or("");
  out.master_config = o.master_config.value_or("");
  out.slave_config = o.slave_config.value_or("");
  out.device = o.device.value_or("");
  out.out = o.out;
  out.json = o.json;
  out.wishes.alone = o.alone;
  return out;
}

ExitCode run_device(const Options& o, const Console& c, bool calibrates) {
  DevicesWords words = devices_words(o);
  words.calibrates = calibrates;
  if (o.force) {
    const auto force = parse_number("--force", *o.force, 0.0, kMostForce, "N");
    if (!force) return complain(c, force.message());
    words.wishes.force = *force;
  }
  catch_interrupts();
  return test_device(words, {c.out, c.err, interrupted});
}

ExitCode run_robot(const Options& o, const Console& c, RobotOrder order) {
  catch_interrupts();
  return run_robot_order({order, o.slave_config.value_or(""), o.override_percent, o.json},
                         {o.master, o.as, c.out, c.err, interrupted});
}

}  // namespace

ExitCode run_robot_status(const Options& o, const Console& c) {
  return run_robot(o, c, RobotOrder::kStatus);
}
ExitCode run_robot_on(const Options& o, const Console& c) {
  return run_robot(o, c, RobotOrder::kOn);
}
ExitCode run_robot_off(const Options& o, const Console& c) {
  return run_robot(o, c, RobotOrder::kOff);
}
ExitCode run_robot_reset(const Options& o, const Console& c) {
  return run_robot(o, c, RobotOrder::kReset);
}

ExitCode run_devices_list(const Options& o, const Console& c) {
  catch_interrupts();
  return list_devices(devices_words(o), {c.out, c.err, interrupted});
}

ExitCode run_devices_test(const Options& o, const Console& c) { return run_device(o, c, false); }

ExitCode run_devices_calibrate(const Options& o, const Console& c) {
  return run_device(o, c, true);
}

ExitCode run_doctor(const Options& options, const Console& console) {
  catch_interrupts();
  DoctorFacts facts;
  facts.version = program_version();
  facts.wire_version = kWireVersion;
  facts.keys = key_facts(default_key_folder());
  facts.programs = local_programs();
  facts.machine = machine_facts();
  facts.realtime_line =
      realtime_permission_line(facts.machine.user) + "   as root, then log in anew";
  facts.master = watch_master(options.master, kWatch, interrupted, facts.machine);
  if (interrupted()) return kExitInterrupted;
  facts.route = route_of(facts.master);
  if (const auto settings = device_settings(devices_words(options))) {
    facts.devices = wanted_devices(*settings);
  } else {
    facts.devices_problem = settings.message();
  }
  facts.largest_datagram = kMaxDatagram + kRecordHeader + kSealing;
  facts.largest_handshake = kLongestHandshake;
  const Findings findings = judge(facts);
  const pb::DoctorReport report = doctor_report(findings);
  console.out << (options.json ? json_text(report, true) + '\n' : doctor_text(findings));
  return report.problems() == 0 ? kExitDone : kExitRefused;
}

}  // namespace handrail
