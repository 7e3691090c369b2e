#include "tests/emulator/edge.h"

#include <algorithm>

#include "tests/emulator/addresses.h"

namespace handrail::emulator {
namespace {

constexpr std::uint16_t kFirstPort = 49152, kPorts = 16384;  // IANA's dynamic ones

}  // namespace

void Edge::roam() noexcept {
  moved_ = static_cast<std::uint8_t>(moved_ % 254 + 1);
  rebind();
}

void Edge::rebind() noexcept {
  mappings_.clear();
  inner_of_.clear();
}

// Behind NAT near's own address is never seen.
Address Edge::seen_address(bool is_6) const noexcept {
  return near_address(is_6, static_cast<std::uint8_t>(moved_ + (settings.nat ? 1 : 0)));
}

bool Edge::alive(const Mapping& mapping, Nanos now) const noexcept {
  return settings.idle <= 0 || now - mapping.used <= settings.idle;
}

void Edge::forget(std::map<Key, Mapping>::iterator at) {
  const auto& [is_6, protocol, port] = at->first;
  inner_of_.erase(Key{is_6, protocol, at->second.outer});
  mappings_.erase(at);
}

Edge::Mapping* Edge::mapping_of(const Key& inner, Nanos now) {
  const auto found = mappings_.find(inner);
  if (found != mappings_.end()) {
    if (alive(found->second, now)) return &found->second;
    forget(found);
  }
  if (mappings_.size() >= kMostPorts) return nullptr;
  const auto& [is_6, protocol, port] = inner;
  Key outer{is_6, protocol, 0};
  do {
    std::get<2>(outer) = static_cast<std::uint16_t>(kFirstPort + random_.bits() % kPorts);
  } while (inner_of_.contains(outer));
  inner_of_[outer] = inner;
  Mapping& made = mappings_[inner];
  made.outer = std::get<2>(outer);
  return &made;
}

bool Edge::outward(std::span<std::uint8_t> packet, Nanos now) {
  const auto layout = layout_of(packet);
  if (!layout) return false;
  Endpoint seen{seen_address(layout->address_size == 16), 0};
  const Endpoint from = source_of(packet, *layout);
  seen.port = from.port;
  if (settings.nat) {
    if (layout->fragment) return false;
    if (layout->has_ports()) {
      Mapping* const mapping =
          mapping_of({layout->address_size == 16, layout->protocol, from.port}, now);
      if (mapping == nullptr) return false;
      mapping->used = now;
      seen.port = mapping->outer;
      const Endpoint to = destination_of(packet, *layout);
      auto& peers = mapping->peers;
      if (std::find(peers.begin(), peers.end(), to) == peers.end()) {
        if (peers.size() == kMostPeers) peers.erase(peers.begin());
        peers.push_back(to);
      }
    }
  }
  if (!(seen == from)) set_source(packet, *layout, seen);
  return true;
}

bool Edge::inward(std::span<std::uint8_t> packet, Nanos now) {
  const auto layout = layout_of(packet);
  if (!layout) return false;
  const bool is_6 = layout->address_size == 16;
  const Endpoint to = destination_of(packet, *layout);
  if (!(to.address == seen_address(is_6))) return false;
  Endpoint inside{near_address(is_6, 0), to.port};
  if (settings.nat) {
    if (layout->fragment) return false;
    if (layout->has_ports()) {
      const auto inner = inner_of_.find({is_6, layout->protocol, to.port});
      if (inner == inner_of_.end()) return false;
      const Mapping& mapping = mappings_.at(inner->second);
      if (!alive(mapping, now)) return false;
      const Endpoint from = source_of(packet, *layout);
      const auto& peers = mapping.peers;
      if (std::find(peers.begin(), peers.end(), from) == peers.end()) return false;
      inside.port = std::get<2>(inner->second);
    }
  }
  if (!(inside == to)) set_destination(packet, *layout, inside);
  return true;
}

}  // namespace handrail::emulator
