#include "server/link/secure/secure_server.h"

#include <algorithm>
#include <utility>

#include "server/link/peer.h"
#include "server/link/secure/record.h"

namespace handrail {

using State = DtlsChannel::State;

void SecureServer::tick(Nanos now) noexcept {
  now_ = now;
  if (now >= refill_) {
    handshakes_.left = kHandshakesPerSecond;
    cookies_.left = kCookiesPerSecond;
    refill_ = now + kSecond;
  }
  for (Slot& slot : slots_) {
    if (slot.channel == nullptr) continue;
    slot.channel->tick();
    if (!slot.open() && now - slot.since > kLongestHandshake) slot.channel->close();
    settle(slot);
  }
}

void SecureServer::set_trusted(TrustList trusted) {
  context_.set_trusted(std::move(trusted));
  for (Slot& slot : slots_) {
    if (slot.channel == nullptr || context_.trusts(slot.channel->peer().key)) continue;
    slot.channel->close();
    settle(slot);
  }
}

std::optional<SessionKeys> SecureServer::take_begun() noexcept {
  if (leader_ == nullptr || std::exchange(leader_->told, true)) return std::nullopt;
  return SessionKeys{leader_->channel->own(), leader_->channel->peer().key};
}

std::optional<Transport::Arrival> SecureServer::receive(std::span<std::uint8_t> buffer) noexcept {
  const auto arrival = socket_.receive(wire_);
  if (!arrival) return std::nullopt;
  last_ = nullptr;
  const auto bytes = std::span<const std::uint8_t>(wire_).first(arrival->size);
  if (!is_records(bytes)) return stranger();
  if (const auto random = client_random(bytes)) {
    Slot* of_it =
        newest_at(arrival->from, [&](const Slot& slot) { return slot.random == *random; });
    return of_it == nullptr ? greet(bytes, arrival->from)
                            : give(*of_it, bytes, arrival->from, buffer);
  }
  if (!is_data(bytes)) {
    Slot* of_it = newest_at(arrival->from, [](const Slot&) { return true; });
    return of_it == nullptr ? stranger() : give(*of_it, bytes, arrival->from, buffer);
  }
  Slot* here = newest_at(arrival->from, [](const Slot& slot) { return slot.open(); });
  if (here != nullptr) {
    if (const Arrival out = give(*here, bytes, arrival->from, buffer); out.from_peer) return out;
  }
  // Of a session that another at this address is to replace, or whose other end has moved.
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (&slots_[i] == here || !slots_[i].open()) continue;
    const Arrival out = give(slots_[i], bytes, arrival->from, buffer);
    if (out.from_peer) return out;
  }
  return stranger();
}

Transport::Arrival SecureServer::give(Slot& slot, std::span<const std::uint8_t> bytes,
                                      const Address& from,
                                      std::span<std::uint8_t> buffer) noexcept {
  const std::size_t size = slot.channel->take(bytes, from, buffer);
  if (size != 0) {
    slot.heard = now_;
    last_ = &slot;
    return {size, true};
  }
  settle(slot);
  return {0, false, true};
}

Transport::Arrival SecureServer::greet(std::span<const std::uint8_t> bytes,
                                       const Address& from) noexcept {
  constexpr Arrival kHandled{0, false, true};
  // What a hello with a cookie would need is asked for before it is looked at: looking begins.
  Slot* const slot = room();
  if (slot == nullptr || handshakes_.left == 0 || !cookies_.take()) {
    ++counts_.over_limit;
    return kHandled;
  }
  if (listener_ == nullptr || listener_->state() != State::kListening) {
    listener_ = DtlsChannel::make(context_, socket_, from);
  }
  if (listener_ == nullptr || !listener_->listen(bytes, from)) return kHandled;
  (void)handshakes_.take();
  if (leader_ == slot) leader_ = nullptr;
  *slot = {std::move(listener_), *client_random(bytes), now_, now_};
  settle(*slot);
  return kHandled;
}

Transport::Arrival SecureServer::stranger() noexcept {
  ++counts_.strangers;
  return {0, false};
}

// What became of a channel.
void SecureServer::settle(Slot& slot) noexcept {
  if (slot.open() && !std::exchange(slot.opened, true)) ++counts_.sessions;
  if (slot.channel->state() != State::kClosed) return;
  const auto problem = slot.channel->problem();
  if (problem != DtlsChannel::Problem::kNone) {
    problem == DtlsChannel::Problem::kUntrusted ? ++counts_.untrusted : ++counts_.failed;
    refused_ = {now_, slot.channel->address(), slot.channel->peer(), problem};
  }
  if (leader_ == &slot) leader_ = nullptr;
  if (last_ == &slot) last_ = nullptr;
  slot = {};
}

// For another session: a slot that is free, that of the oldest handshake, or of a session that does
// not lead and has been silent for longest; null: all are in use.
SecureServer::Slot* SecureServer::room() noexcept {
  Slot* best = nullptr;
  for (Slot& slot : slots_) {
    if (slot.channel == nullptr) return &slot;
    if (slot.open() && (&slot == leader_ || now_ - slot.heard <= kTakeoverSilence)) continue;
    if (best == nullptr || slot.heard < best->heard) best = &slot;
  }
  return best;
}

template <typename Fits>
SecureServer::Slot* SecureServer::newest_at(const Address& from, Fits fits) noexcept {
  Slot* best = nullptr;
  for (Slot& slot : slots_) {
    if (slot.channel == nullptr || slot.channel->address() != from || !fits(slot)) continue;
    if (best == nullptr || slot.since >= best->since) best = &slot;
  }
  return best;
}

void SecureServer::adopt_sender() noexcept {
  if (last_ == nullptr) return;
  leader_ = last_;
  leader_->channel->move_to_sender();
}

bool SecureServer::send(std::span<const std::uint8_t> bytes) noexcept {
  return leader_ != nullptr && leader_->channel->send(bytes);
}

bool SecureServer::answer(std::span<const std::uint8_t> bytes) noexcept {
  return last_ != nullptr && last_->channel->send(bytes);
}

std::string_view SecureServer::peer_name() const noexcept {
  if (leader_ == nullptr) return {};
  const Trusted* who = context_.trusted().find(leader_->channel->peer().key);
  return who == nullptr ? std::string_view() : std::string_view(who->name);
}

const DtlsChannel* SecureServer::leader() const noexcept {
  return leader_ == nullptr ? nullptr : leader_->channel.get();
}

Nanos SecureServer::leader_since() const noexcept {
  return leader_ == nullptr ? 0 : leader_->since;
}

}  // namespace handrail
