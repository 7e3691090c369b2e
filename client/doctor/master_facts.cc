#include <algorithm>

#include "client/api/operator_client.h"
#include "client/doctor/gather.h"
#include "client/doctor/machine_cost.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

constexpr Nanos kPeriod = 20 * kMillisecond;
constexpr Nanos kPatience = 2 * kSecond;  // for an answer

void add(const pb::Status& status, MasterFacts& out) {
  // Neither is measured while nothing new comes: what was is not counted twice.
  const bool news = !out.status || status.datagrams_accepted() != out.status->datagrams_accepted();
  if (news && status.round_trip_ms() >= 0.0) out.round_trips_ms.push_back(status.round_trip_ms());
  if (status.loop_age_ms() >= 0.0) out.loop_ages_ms.push_back(status.loop_age_ms());
  out.status = status;
}

}  // namespace

MasterFacts watch_master(const MasterPlace& place, double seconds, bool (*cancelled)(),
                         MachineFacts& machine) {
  MasterFacts out;
  out.place = place;
  OperatorClient client(place, {}, cancelled);
  pb::Request request;
  request.set_status(true);
  MachineCost cost;
  const Nanos start = monotonic_now();
  Nanos due = start;
  while (to_seconds(due - start) < seconds && !(cancelled != nullptr && cancelled())) {
    due += kPeriod;
    sleep_until(due);
    cost.waited(due, monotonic_now());
    if (!out.problem.empty()) continue;
    const Result<pb::Reply> reply = client.call(request, kPatience);
    if (!reply) out.problem = reply.message();
    if (!reply) out.absent = reply.message().ends_with(kStartMaster);
    if (reply && !reply->done()) out.problem = reply->reason();
    if (!out.problem.empty()) {
      out.status.reset();
    } else {
      add(reply->status(), out);
    }
    // What the master took for its answer is no pause of ours.
    due = std::max(due, monotonic_now() - kPeriod);
  }
  out.watched_s = machine.watched_s = to_seconds(monotonic_now() - start);
  machine.pauses = cost.pauses();
  machine.longest_pause_ms = to_seconds(cost.longest()) * 1e3;
  const double stolen = cost.stolen_s();
  if (stolen >= 0.0 && machine.watched_s > 0.0) machine.stolen_share = stolen / machine.watched_s;
  return out;
}

}  // namespace handrail
