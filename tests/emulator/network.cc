#include "tests/emulator/network.h"

#include <algorithm>

namespace handrail::emulator {
namespace {

// At 20 000 packets a second, with 0.4 s of delay and all that jitter lets arrive at once.
constexpr WaySize kWay{
    .longest = kLongestPacket, .under_way = 8192, .socket_queue = 8192, .headers = 0};

// Those that are due, taken off the front; how many.
std::size_t take_due(std::vector<Nanos>& times, Nanos now) {
  const auto end = std::upper_bound(times.begin(), times.end(), now);
  const auto count = static_cast<std::size_t>(end - times.begin());
  times.erase(times.begin(), end);
  return count;
}

void add(const std::vector<Nanos>& times, Nanos now, std::vector<Nanos>& to) {
  for (const Nanos at : times) to.push_back(now + at);
  std::sort(to.begin(), to.end());
}

}  // namespace

Network::Network(std::uint64_t seed)
    : to_far_{.link = {seed, kWay}, .counts = {}},
      to_near_{.link = {~seed, kWay}, .counts = {}},
      edge_(seed ^ 0xed9eULL),
      packet_(kLongestPacket) {}

void Network::begin(const NetworkPlan& plan, Nanos now) {
  outages_.clear();
  rebinds_.clear();
  roams_.clear();
  change(plan, now);
}

void Network::change(const NetworkPlan& plan, Nanos now) {
  to_far_.link.faults = plan.to_far;
  to_near_.link.faults = plan.to_near;
  edge_.settings = plan.edge;
  for (Outage outage : plan.outages) {
    outage.from += now;
    outage.until += now;
    outages_.push_back(outage);
  }
  add(plan.rebinds, now, rebinds_);
  add(plan.roams, now, roams_);
}

void Network::move_edge(Nanos now) {
  if (take_due(rebinds_, now) > 0) edge_.rebind();
  for (std::size_t left = take_due(roams_, now); left > 0; --left) edge_.roam();
}

bool Network::is_dark(Side to, Nanos now) const noexcept {
  return std::any_of(outages_.begin(), outages_.end(), [&](const Outage& outage) {
    return (to == Side::kFar ? outage.to_far : outage.to_near) && outage.from <= now &&
           now < outage.until;
  });
}

std::uint64_t Network::send(Side from, std::span<const std::uint8_t> packet, Nanos now) {
  move_edge(now);
  const Side to = other(from);
  Way& way = way_to(to);
  const auto layout = layout_of(packet);
  if (!layout || packet.size() > packet_.size() ||
      is_local(destination_of(packet, *layout).address)) {
    ++way.counts.ignored;
    return 0;
  }
  ++way.counts.sent;
  std::copy(packet.begin(), packet.end(), packet_.begin());
  const std::span<std::uint8_t> sent = std::span(packet_).first(packet.size());
  if (from == Side::kNear && !edge_.outward(sent, now)) {
    ++way.counts.nobodys;
    return 0;
  }
  // An outage is loss of everything, so that it does not deal the other faults anew.
  const double loss = way.link.faults.loss;
  const std::uint64_t lost = way.link.counters().lost;
  const bool dark = is_dark(to, now);
  if (dark) way.link.faults.loss = 1.0;
  way.link.send(sent, now, layout->body);
  way.link.faults.loss = loss;
  if (dark) way.counts.dark += way.link.counters().lost - lost;
  return way.link.counters().sent;
}

void Network::inject(Side to, std::span<const std::uint8_t> packet, Nanos now) {
  way_to(to).link.inject(packet, now);
}

Nanos Network::next_due() const noexcept {
  return std::min(to_far_.link.next_due(), to_near_.link.next_due());
}

std::optional<Arrived> Network::take_from(Side to, Nanos due, std::span<std::uint8_t> out) {
  Way& way = way_to(to);
  const std::size_t size = way.link.receive(out, due);
  if (size == 0) return std::nullopt;
  const Delivery delivery = way.link.deliveries().front();
  way.link.clear_deliveries();
  const std::span<std::uint8_t> packet = out.first(size);
  if (delivery.origin == Origin::kCorrupt) {
    if (const auto layout = layout_of(packet)) repair(packet, *layout);
  }
  const bool translated = to == Side::kNear && delivery.origin != Origin::kInjected;
  if (translated && !edge_.inward(packet, due)) {
    ++way.counts.nobodys;
    return Arrived{.at = to, .size = 0, .due = due};
  }
  ++way.counts.delivered;
  return Arrived{to, size, delivery.number, delivery.origin, due};
}

std::optional<Arrived> Network::take(Nanos now, std::span<std::uint8_t> out) {
  for (;;) {
    for (const Side to : {Side::kFar, Side::kNear}) {
      while (const auto arrived = take_from(to, arriving_, out)) {
        if (arrived->size > 0) return arrived;
      }
    }
    if (next_due() > now) return std::nullopt;
    arriving_ = next_due();
    move_edge(arriving_);
    to_far_.link.advance(arriving_);
    to_near_.link.advance(arriving_);
  }
}

Counts Network::counts(Side to) const noexcept {
  const Way& way = way_to(to);
  const WayCounters& link = way.link.counters();
  Counts out = way.counts;
  out.lost = link.lost - out.dark;
  out.overflow = link.overflow;
  out.duplicated = link.duplicated;
  out.replayed = link.replayed;
  out.corrupted = link.corrupted;
  out.injected = link.injected;
  return out;
}

}  // namespace handrail::emulator
