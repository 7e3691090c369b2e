// Two sockets on a network that loses, repeats and changes what a test wants, and the keys of both
// ends.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "server/base/random.h"
#include "server/keys/own_key.h"
#include "server/link/secure/secure_client.h"
#include "server/link/secure/secure_server.h"

namespace handrail::test {

using Bytes = std::vector<std::uint8_t>;

// The calendar, which OpenSSL's timers go by.
extern Nanos wall_clock;

inline Address address_of(std::uint8_t host, std::uint16_t port) {
  return {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 192, 0, 2, host}, port, 0};
}

// Datagrams wait at the address they were sent to. Everything that was ever sent is in `sent`.
class MadeUpNet {
 public:
  struct Datagram {
    Address from, to;
    Bytes bytes;
  };
  // False: the datagram is lost. May change it.
  std::function<bool(Datagram&)> passes = [](Datagram&) { return true; };
  std::vector<Datagram> sent;

  void put(Datagram datagram) { waiting_[key(datagram.to)].push_back(std::move(datagram)); }
  void send(Datagram datagram) {
    sent.push_back(datagram);
    if (passes(datagram)) put(std::move(datagram));
  }
  std::optional<Datagram> take(const Address& at) {
    auto& queue = waiting_[key(at)];
    if (queue.empty()) return std::nullopt;
    Datagram out = std::move(queue.front());
    queue.pop_front();
    return out;
  }

 private:
  static std::pair<std::array<std::uint8_t, 16>, std::uint16_t> key(const Address& a) {
    return {a.ip, a.port};
  }
  std::map<std::pair<std::array<std::uint8_t, 16>, std::uint16_t>, std::deque<Datagram>> waiting_;
};

class MadeUpSocket final : public DatagramSocket {
 public:
  MadeUpSocket(MadeUpNet& net, const Address& own) : net_(net), own_(own) {}
  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override {
    if (quiet) {
      if (prepared == nullptr) return std::nullopt;
      const MadeUpNet::Datagram& datagram = *std::exchange(prepared, nullptr);
      std::copy(datagram.bytes.begin(), datagram.bytes.end(), buffer.begin());
      return Arrival{datagram.bytes.size(), datagram.from};
    }
    auto datagram = net_.take(own_);
    if (!datagram) return std::nullopt;
    const std::size_t size = std::min(buffer.size(), datagram->bytes.size());
    std::copy_n(datagram->bytes.begin(), size, buffer.begin());
    return Arrival{size, datagram->from};
  }
  bool send(std::span<const std::uint8_t> bytes, const Address& to) noexcept override {
    if (quiet) return true;
    net_.send({own_, to, Bytes(bytes.begin(), bytes.end())});
    return true;
  }
  const Address& own() const { return own_; }
  // The network, which allocates, is left out: `prepared` is received once, what is sent is lost.
  bool quiet = false;
  const MadeUpNet::Datagram* prepared = nullptr;
  void move_to(const Address& own) { own_ = own; }

 private:
  MadeUpNet& net_;
  Address own_;
};

inline TrustList trusting(const std::vector<Trusted>& entries) {
  TrustList out;
  for (const Trusted& entry : entries) (void)out.add(entry);
  return out;
}

// A slave that listens and a master that calls it, which trust each other.
struct SecurePair {
  OwnKey slave_key = *OwnKey::generate();
  OwnKey master_key = *OwnKey::generate();
  MadeUpNet net;
  MadeUpSocket slave_socket{net, address_of(1, 47002)};
  MadeUpSocket master_socket{net, address_of(2, 50000)};
  std::unique_ptr<SecureContext> slave_context = context(
      slave_key, {{"desk", Role::kMaster, master_key.public_key()}}, SecureContext::Side::kServer);
  std::unique_ptr<SecureContext> master_context = context(
      master_key, {{"cell", Role::kSlave, slave_key.public_key()}}, SecureContext::Side::kClient);
  SecureServer slave{*slave_context, slave_socket};
  SecureClient master{*master_context, master_socket};
  std::vector<Bytes> slave_got, master_got;
  int slave_strangers = 0, master_strangers = 0;
  Nanos now = 0;

  SecurePair() { master.set_addresses({slave_socket.own()}); }

  static std::unique_ptr<SecureContext> context(const OwnKey& key,
                                                const std::vector<Trusted>& trusted,
                                                SecureContext::Side side) {
    const bool client = side == SecureContext::Side::kClient;
    return std::move(
        *SecureContext::make(key, trusting(trusted), side, client ? Role::kSlave : Role::kMaster));
  }
  // What waits at an end, as the pump takes it: what is of the peer is accepted.
  template <typename End>
  static void drain(End& end, std::vector<Bytes>& got, int& strangers) {
    std::array<std::uint8_t, 549> buffer{};
    while (const auto arrival = end.receive(buffer)) {
      if (arrival->handled) continue;
      if (!arrival->from_peer) {
        ++strangers;
        continue;
      }
      end.adopt_sender();
      got.emplace_back(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(arrival->size));
    }
  }
  void step() {
    now += kMillisecond;
    wall_clock += kMillisecond;
    master.tick(now);
    slave.tick(now);
    drain(slave, slave_got, slave_strangers);
    drain(master, master_got, master_strangers);
  }
  // Until a session is open at the master, at most so many milliseconds.
  bool connect(int steps = 100) {
    for (int i = 0; i < steps && master.session() == nullptr; ++i) step();
    return master.session() != nullptr;
  }
  bool say(const Bytes& what) {
    const bool sent = master.send(what);
    step();
    return sent;
  }
};

}  // namespace handrail::test
