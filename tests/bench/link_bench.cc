// One datagram of the link, written and read, on seeded states; and a slave's datagram there and
// back through the plain link's sockets, beside the same over UDP.
#include <array>
#include <cstdlib>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/link/peer.h"
#include "server/link/unix_transport.h"
#include "tests/bench/percentile.h"
#include "tests/bench/secure_keys.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/link/link_samples.h"

namespace handrail::bench {
namespace {

// Encodes and decodes one datagram of the master.
struct MasterThereAndBack {
  Codec codec;
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  DatagramHeader header = sample_header();
  MasterState state = sample_master();
  MasterState* operator()() {
    Reject cause = Reject::kNone;
    ++header.sequence;
    const std::size_t size = codec.encode(header, state, bytes, cause);
    benchmark::DoNotOptimize(codec.decode(std::span(bytes).first(size), header, state));
    return &state;
  }
};

// A whole millisecond of both ends: each sends once and takes the other's.
struct BothEnds {
  MasterPeer master{1};
  SlavePeer slave{2};
  MasterState master_state = sample_master();
  SlaveState slave_state = sample_slave();
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  Nanos now = kSecond;
  const SlaveState* operator()() {
    now += kMillisecond;
    std::size_t size = master.poll(now, master_state, bytes);
    benchmark::DoNotOptimize(slave.on_datagram(std::span(bytes).first(size), now));
    size = slave.poll(now, slave_state, bytes);
    benchmark::DoNotOptimize(master.on_datagram(std::span(bytes).first(size), now));
    return &master.newest();
  }
};

using Datagram = std::array<std::uint8_t, 512>;  // of a slave

std::size_t there_and_back_of(Transport& master, Transport& slave, Datagram& bytes) {
  (void)master.send(bytes);
  (void)slave.receive(bytes);
  slave.adopt_sender();
  (void)slave.send(bytes);
  const auto back = master.receive(bytes);
  if (!back || !back->from_peer) std::abort();
  return back->size;
}

struct UnixThereAndBack {
  TempFolder folder;
  boost::asio::io_context io;
  UnixTransport slave{io, UnixTransport::End::kSlave, folder.path() + "/link.sock"};
  UnixTransport master{io, UnixTransport::End::kMaster, folder.path() + "/link.sock"};
  Datagram bytes{};
  UnixThereAndBack() {
    if (!slave.open() || !master.open()) std::abort();
  }
  std::size_t operator()() { return there_and_back_of(master, slave, bytes); }
};

struct UdpThereAndBack {
  using Udp = boost::asio::ip::udp;
  boost::asio::io_context io;
  Udp::socket slave{io, {boost::asio::ip::address_v4::loopback(), 0}};
  Udp::socket master{io, {boost::asio::ip::address_v4::loopback(), 0}};
  const Udp::endpoint to_slave = slave.local_endpoint();
  Datagram bytes{};
  std::size_t operator()() {
    Udp::endpoint from;
    master.send_to(boost::asio::buffer(bytes), to_slave);
    slave.receive_from(boost::asio::buffer(bytes), from);
    slave.send_to(boost::asio::buffer(bytes), from);
    return master.receive_from(boost::asio::buffer(bytes), from);
  }
};

// Both ends of an encrypted session over UDP.
struct SecureThereAndBack {
  SecureKeys keys;
  boost::asio::io_context io;
  UdpSocket slave_socket{io}, master_socket{io};
  SecureServer slave{*keys.slave_context, slave_socket};
  SecureClient master{*keys.master_context, master_socket};
  Datagram bytes{};

  SecureThereAndBack() {
    if (!slave_socket.open("127.0.0.1", 0) || !master_socket.open("127.0.0.1", 0)) std::abort();
    master.set_addresses({loopback_address(slave_socket.port())});
    for (Nanos now = 0; master.session() == nullptr; now += kMillisecond) {
      if (now > kSecond) std::abort();
      master.tick(now);
      slave.tick(now);
      for (int i = 0; i < 8; ++i) {
        (void)slave.receive(bytes);
        (void)master.receive(bytes);
      }
    }
  }
  std::size_t operator()() { return there_and_back_of(master, slave, bytes); }
};

// By reference: sockets do not move.
template <typename Way>
void there_and_back(benchmark::State& state, const char* name) {
  Way way;
  run(state, name, 1, 0.0, [&way] { return way(); });
}
void BM_LinkUnixSocket(benchmark::State& state) {
  there_and_back<UnixThereAndBack>(state, "link, there and back through its Unix sockets");
}
void BM_LinkUdp(benchmark::State& state) {
  there_and_back<UdpThereAndBack>(state, "the same over UDP");
}
void BM_LinkSecure(benchmark::State& state) {
  there_and_back<SecureThereAndBack>(state, "the same over UDP, encrypted");
}
void BM_LinkCodec(benchmark::State& state) {
  run(state, "link datagram, encode + decode", 1, 0.0, MasterThereAndBack{});
}
void BM_LinkBothEnds(benchmark::State& state) {
  run(state, "link, both ends of one millisecond", 1, 0.0, BothEnds{});
}
BENCHMARK(BM_LinkCodec);
BENCHMARK(BM_LinkBothEnds);
BENCHMARK(BM_LinkUnixSocket);
BENCHMARK(BM_LinkUdp);
BENCHMARK(BM_LinkSecure);

}  // namespace
}  // namespace handrail::bench
