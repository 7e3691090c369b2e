#include "tests/emulator/network_io.h"

#include <filesystem>

#include "proto/network.pb.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"
#include "server/scene/text_io.h"

namespace handrail::emulator {
namespace {

Nanos in_ms(double ms) { return from_seconds(ms * 1e-3); }

void put_way(const pb::Network::Way& in, LinkFaults& out) {
  if (in.has_delay_ms()) out.delay = in_ms(in.delay_ms());
  if (in.has_jitter_ms()) out.jitter = in_ms(in.jitter_ms());
  if (in.has_loss()) out.loss = in.loss();
  if (in.has_burst_enter()) out.burst_enter = in.burst_enter();
  if (in.has_burst_leave()) out.burst_leave = in.burst_leave();
  if (in.has_duplicate()) out.duplicate = in.duplicate();
  if (in.has_reorder()) out.reorder = in.reorder();
  if (in.has_reorder_by_ms()) out.reorder_by = in_ms(in.reorder_by_ms());
  if (in.has_replay()) out.replay = in.replay();
  if (in.has_corrupt()) out.corrupt = in.corrupt();
  if (in.has_corrupt_bits()) out.corrupt_bits = in.corrupt_bits();
  if (in.has_corrupt_copies()) out.corrupt_copies = in.corrupt_copies();
  if (in.has_rate_kbit_s()) out.rate_bps = static_cast<std::int64_t>(in.rate_kbit_s() * 1e3);
  if (in.has_queue_ms()) out.queue = in_ms(in.queue_ms());
}

Outage outage_from(const pb::Network::Outage& in) {
  const Nanos from = from_seconds(in.from_s());
  return {from, from + from_seconds(in.for_s()), in.way() != pb::Network::TO_NEAR,
          in.way() != pb::Network::TO_FAR};
}

void put(const pb::Network& in, NetworkPlan& out) {
  for (LinkFaults* way : {&out.to_far, &out.to_near}) put_way(in.both(), *way);
  put_way(in.to_far(), out.to_far);
  put_way(in.to_near(), out.to_near);
  if (in.edge().has_nat()) out.edge.nat = in.edge().nat();
  if (in.edge().has_idle_s()) out.edge.idle = from_seconds(in.edge().idle_s());
  out.outages.clear();
  out.rebinds.clear();
  out.roams.clear();
  for (const auto& outage : in.outage()) out.outages.push_back(outage_from(outage));
  for (const double at : in.edge().rebind_at_s()) out.rebinds.push_back(from_seconds(at));
  for (const double at : in.edge().roam_at_s()) out.roams.push_back(from_seconds(at));
}

// What a person who meant something else could have meant.
std::string no_such(const std::string& name) {
  std::vector<std::string> names;
  for (const KnownNetwork& network : known_networks()) names.emplace_back(network.name);
  const std::string nearest = nearest_name(name, names);
  return "'" + name + "': neither a file nor a network's name" +
         (nearest.empty() ? "; the names are " + joined(names, ", ")
                          : "; did you mean '" + nearest + "'?");
}

}  // namespace

Result<NetworkPlan> load_network(const std::string& name_or_path) {
  NetworkPlan out;
  if (const KnownNetwork* known = find_network(name_or_path)) {
    out.to_far = out.to_near = known->way;
    return out;
  }
  std::error_code error;
  if (!std::filesystem::exists(name_or_path, error)) return Status::error(no_such(name_or_path));
  const Result<std::string> text = read_file(name_or_path, TextSource::kMaxBytes);
  if (!text) return text.status();
  if (Status changed = change_network(name_or_path, *text, out); !changed) return changed;
  return out;
}

Status change_network(const std::string& place, std::string_view text, NetworkPlan& plan) {
  TextSource source;
  pb::Network message;
  if (Status parsed = source.parse(place, text, message); !parsed) return parsed;
  NetworkPlan changed = plan;
  put(message, changed);
  const bool rebinds = message.edge().rebind_at_s_size() > 0 || message.edge().has_idle_s();
  if (rebinds && !changed.edge.nat) {
    const char* field = message.edge().has_idle_s() ? "edge.idle_s" : "edge.rebind_at_s";
    return source.error_at(
        {field, "without nat there are no ports to give up, expected nat: true"});
  }
  plan = changed;
  return Status::ok();
}

}  // namespace handrail::emulator
