#include "client/cli/doctor_command.h"

#include "client/cli/interrupt.h"
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

}  // namespace

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
  facts.largest_datagram = kMaxDatagram + kRecordHeader + kSealing;
  facts.largest_handshake = kLongestHandshake;
  const Findings findings = judge(facts);
  const pb::DoctorReport report = doctor_report(findings);
  console.out << (options.json ? json_text(report, true) + '\n' : doctor_text(findings));
  return report.problems() == 0 ? kExitDone : kExitRefused;
}

}  // namespace handrail
