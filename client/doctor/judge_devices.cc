#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

void judge_sighting(const std::string& name, const Sighting& seen, Findings& out) {
  const std::string place = seen.place.empty() ? "" : seen.place + ": ";
  const bool ready = seen.readiness == Readiness::kReady;
  out.push_back({"device." + name, ready ? Level::kOk : Level::kProblem, place + seen.fact,
                 ready ? "" : seen.next});
}

}  // namespace

void judge_devices(const DoctorFacts& facts, Findings& out) {
  if (!facts.devices_problem.empty()) {
    out.push_back({"device.configuration", Level::kProblem, facts.devices_problem,
                   "correct that file; the daemon's own --check says the same of it"});
  }
  for (const DeviceFacts& device : facts.devices) {
    for (const Sighting& seen : device.seen) judge_sighting(device.name, seen, out);
  }
  if (!facts.master.status) return;
  const pb::Status& s = status_of(facts);
  if (s.has_device()) {
    const bool sound = !s.has_device_trouble();
    out.push_back({"device.hand", sound ? Level::kOk : Level::kProblem,
                   "the master's device is " + s.device() +
                       (s.device_simulated() ? ", simulated" : "") +
                       (sound ? "" : ": " + s.device_trouble()),
                   sound ? "" : "'handrail status' shows when it is heard again"});
  }
  if (s.has_handle()) {
    const bool sound = s.handle().has_force();
    out.push_back({"device.handle", sound ? Level::kOk : Level::kNote,
                   "the force sensor on the handle" +
                       std::string(s.handle().simulated() ? ", simulated: " : ": ") +
                       s.handle().state(),
                   sound ? "" : "with the master ended: handrail devices test handle-ft"});
  }
  // Of walls for the hand alone there is no sensor.
  if (!slave_is_heard(s) || s.has_walls()) return;
  const bool sound = s.has_contact_force();
  out.push_back(
      {"device.sensor", sound ? Level::kOk : Level::kNote,
       sound ? "the slave has sound readings of its force sensor"
             : "the slave has no sound reading of a force sensor: nothing yields at a "
               "contact",
       sound ? "" : "on the slave's computer, with the slave ended: handrail devices test net-ft"});
}

}  // namespace handrail
