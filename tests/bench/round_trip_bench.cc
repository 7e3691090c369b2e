// What encryption costs a round trip as it is in use: an echo in a thread of its own, which the
// kernel wakes for each message, over this computer's loopback. The secured link, plain UDP by Asio
// and ZeroMQ over TCP, one after the other within each round of one run, so that what else the
// computer does meets all of them alike. At 1 kHz each, and one behind the other; both ends on one
// core, and on two: where the kernel puts them decides more than anything else, and it does not put
// all of them alike. On two also with both ends polling, as with `busy_poll: true`, while a message
// is under way.
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio.hpp>

#ifdef HANDRAIL_BENCH_ZMQ
#include <zmq.hpp>
#endif

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/bench/percentile.h"
#include "tests/bench/secure_keys.h"

namespace handrail::bench {
namespace {

namespace asio = boost::asio;
using Message = std::array<std::uint8_t, 512>;  // a slave's datagram

// One way to an echo and back.
class Way {
 public:
  virtual ~Way() = default;
  // Sends a message and waits for it to come back; the program ends where it does not.
  virtual std::size_t ping() = 0;
  // From now on the echo polls, or sleeps until it is woken, if it is one that can.
  virtual void poll(bool /*on*/) {}
};

// Holds the calling thread on the first core that the program may use, or on the last. Threads that
// it makes stay there too.
void stay_on(bool first) {
  static const cpu_set_t allowed = [] {
    cpu_set_t out;
    if (sched_getaffinity(0, sizeof out, &out) != 0) std::abort();
    return out;
  }();
  int core = first ? 0 : CPU_SETSIZE - 1;
  while (!CPU_ISSET(core, &allowed)) core += first ? 1 : -1;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(core, &one);
  if (pthread_setaffinity_np(pthread_self(), sizeof one, &one) != 0) std::abort();
}

// An io_context and the thread that serves it.
class Echo {
 public:
  Echo() = default;
  ~Echo() { end(); }
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;
  void serve(bool on_first) {
    thread_ = std::thread([this, on_first] {
      stay_on(on_first);
      while (!io.stopped()) {
        if (polls_) {
          io.poll();
        } else {
          io.run_one();
        }
      }
    });
  }
  // Before what it serves ends.
  void end() {
    io.stop();
    if (thread_.joinable()) thread_.join();
  }
  void poll(bool on) {
    polls_ = on;
    asio::post(io, [] {});  // wakes it
    if (on) std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
  asio::io_context io{1};

 private:
  std::atomic<bool> polls_{false};
  std::thread thread_;
};

// Waits until `there` says so: in the kernel, or by asking it again and again.
template <typename There>
void wait_in(asio::io_context& io, bool polls, There there) {
  io.restart();  // with nothing to wait for it has ended
  const Nanos start = monotonic_now();
  while (!there()) {
    if (monotonic_now() - start > 2 * kSecond) std::abort();
    if (polls) {
      io.poll();
    } else {
      io.run_one_for(std::chrono::seconds(2));
    }
  }
}

class PlainUdp final : public Way {
  using Udp = asio::ip::udp;

 public:
  explicit PlainUdp(bool one_core, bool polls = false) : polls_(polls) {
    listen();
    echo_.serve(one_core);
  }
  ~PlainUdp() override { echo_.end(); }
  void poll(bool on) override {
    if (polls_) echo_.poll(on);
  }
  std::size_t ping() override {
    std::size_t size = 0;
    socket_.send_to(asio::buffer(bytes_), to_);
    socket_.async_receive_from(asio::buffer(bytes_), from_,
                               [&](const auto& error, std::size_t n) { size = error ? 0 : n; });
    wait_in(io_, polls_, [&] { return size != 0; });
    return size;
  }

 private:
  void listen() {
    echo_socket_.async_receive_from(
        asio::buffer(echo_bytes_), echo_from_, [this](const auto& error, std::size_t size) {
          if (error) return;
          echo_socket_.send_to(asio::buffer(echo_bytes_.data(), size), echo_from_);
          listen();
        });
  }

  const bool polls_;
  Message bytes_{}, echo_bytes_{};
  Udp::endpoint from_, echo_from_;
  asio::io_context io_{1};
  Echo echo_;
  Udp::socket socket_{io_, {asio::ip::address_v4::loopback(), 0}};
  Udp::socket echo_socket_{echo_.io, {asio::ip::address_v4::loopback(), 0}};
  const Udp::endpoint to_ = echo_socket_.local_endpoint();
};

// The daemons' own classes, served as `LinkServer` serves them.
class Secured final : public Way {
 public:
  explicit Secured(bool one_core, bool polls = false) : polls_(polls) {
    if (!slave_socket_.open("any", 0) || !master_socket_.open("any", 0)) std::abort();
    master_.set_addresses({loopback_address(slave_socket_.port())});
    slave_socket_.on_readable([this] { echo(); });
    master_socket_.on_readable([this] { take(); });
    echo_.serve(one_core);
    const Nanos start = monotonic_now();
    while (master_.session() == nullptr) {
      if (monotonic_now() - start > 10 * kSecond) std::abort();
      master_.tick(monotonic_now());
      io_.run_one_for(std::chrono::milliseconds(1));
    }
  }
  ~Secured() override { echo_.end(); }
  void poll(bool on) override {
    if (polls_) echo_.poll(on);
  }
  std::size_t ping() override {
    got_ = 0;
    if (!master_.send(bytes_)) std::abort();
    wait_in(io_, polls_, [this] { return got_ != 0; });
    return got_;
  }

 private:
  void echo() {
    slave_.tick(monotonic_now());
    while (const auto arrival = slave_.receive(echo_bytes_)) {
      if (!arrival->from_peer) continue;
      slave_.adopt_sender();
      (void)slave_.send(std::span(echo_bytes_).first(arrival->size));
    }
  }
  void take() {
    while (const auto arrival = master_.receive(bytes_)) {
      if (arrival->from_peer) got_ = arrival->size;
    }
  }

  const bool polls_;
  SecureKeys keys_;
  Message bytes_{}, echo_bytes_{};
  std::size_t got_ = 0;
  asio::io_context io_{1};
  Echo echo_;
  UdpSocket slave_socket_{echo_.io}, master_socket_{io_};
  SecureServer slave_{*keys_.slave_context, slave_socket_};
  SecureClient master_{*keys_.master_context, master_socket_};
};

#ifdef HANDRAIL_BENCH_ZMQ
class ZeroMq final : public Way {
 public:
  explicit ZeroMq(bool one_core) {
    socket_.set(zmq::sockopt::rcvtimeo, 2000);
    thread_ = std::thread([this, one_core] {
      stay_on(one_core);
      echo();
    });
    socket_.connect(at_.get_future().get());
  }
  ~ZeroMq() override {
    socket_.send(zmq::message_t(), zmq::send_flags::none);
    thread_.join();
  }
  std::size_t ping() override {
    socket_.send(zmq::buffer(bytes_), zmq::send_flags::none);
    const auto got = socket_.recv(zmq::buffer(bytes_));
    if (!got) std::abort();
    return got->size;
  }

 private:
  void echo() {
    zmq::context_t context;  // as of another program: with a thread of its own for its sockets
    zmq::socket_t socket(context, zmq::socket_type::pair);
    socket.bind("tcp://127.0.0.1:*");
    at_.set_value(socket.get(zmq::sockopt::last_endpoint));
    zmq::message_t message;
    while (socket.recv(message) && message.size() > 0) {
      socket.send(message, zmq::send_flags::none);
    }
  }

  Message bytes_{};
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::pair};
  std::promise<std::string> at_;
  std::thread thread_;
};
#endif

struct Measured {
  std::string name;
  std::unique_ptr<Way> way;
  Samples samples{};
};

std::vector<Measured> ways(bool one_core) {
  std::vector<Measured> out;
  out.push_back({"Asio UDP", std::make_unique<PlainUdp>(one_core)});
  out.push_back({"secured link", std::make_unique<Secured>(one_core)});
  if (!one_core) {
    out.push_back({"polled Asio UDP", std::make_unique<PlainUdp>(one_core, true)});
    out.push_back({"polled secured link", std::make_unique<Secured>(one_core, true)});
  }
#ifdef HANDRAIL_BENCH_ZMQ
  out.push_back({"ZeroMQ TCP", std::make_unique<ZeroMq>(one_core)});
#endif
  return out;
}

// `pace`: of the rounds, in which every way has a part of its own; 0: one behind the other.
void round_trips(benchmark::State& state, const std::string& how, Nanos pace, bool one_core) {
  stay_on(true);
  std::vector<Measured> all = ways(one_core);
  const auto count = static_cast<Nanos>(all.size());
  for (Measured& one : all) {
    for (int i = 0; i < 200; ++i) (void)one.way->ping();
  }
  Nanos next = monotonic_now();
  std::mt19937 order(1);
  for ([[maybe_unused]] auto _ : state) {
    // None is always behind the same neighbour.
    std::shuffle(all.begin(), all.end(), order);
    for (Measured& one : all) {
      if (pace > 0) sleep_until(next);
      one.way->poll(true);
      one.samples.time([&] { return one.way->ping(); });
      one.way->poll(false);
      next = std::max(next + pace / count, monotonic_now() - pace);
    }
  }
  const auto named = [&how](const std::string& name) { return "round trip " + how + ", " + name; };
  for (const Measured& one : all) {
    put(named(one.name), one.samples);
    const Summary s = one.samples.summary();
    const std::string key = one.name.substr(0, one.name.rfind(' '));
    state.counters[key + "_median_ns"] = s.median;
    state.counters[key + "_p99_ns"] = s.p99;
    state.counters[key + "_p999_ns"] = s.p999;
    state.counters[key + "_worst_ns"] = s.worst;
  }
  state.SetLabel("interleaved");
  // Wanted: what encryption may add to a round trip, and how far below a queue over TCP it stays.
  compare(named("secured link"), named("Asio UDP"), 1.35);
  compare_99(named("secured link"), named("Asio UDP"), 1.5);
  compare(named("secured link"), named("ZeroMQ TCP"), 1.0 / 3.0);
  if (!one_core) compare(named("polled secured link"), named("ZeroMQ TCP"), 1.0 / 3.0);
#ifndef HANDRAIL_BENCH_ZMQ
  remark(named("ZeroMQ TCP") + ": not measured, built without libzmq3-dev and cppzmq-dev");
#endif
}

void BM_RoundTripPaced(benchmark::State& state) {
  round_trips(state, "1 kHz, one core", kMillisecond, true);
}
void BM_RoundTripPacedTwoCores(benchmark::State& state) {
  round_trips(state, "1 kHz, two cores", kMillisecond, false);
}
void BM_RoundTripAtOnce(benchmark::State& state) {
  round_trips(state, "at once, one core", 0, true);
}
void BM_RoundTripAtOnceTwoCores(benchmark::State& state) {
  round_trips(state, "at once, two cores", 0, false);
}
// 20 s each that is paced: the 99.9 % are of twenty.
BENCHMARK(BM_RoundTripPaced)->Iterations(20'000);
BENCHMARK(BM_RoundTripPacedTwoCores)->Iterations(20'000);
BENCHMARK(BM_RoundTripAtOnce)->Iterations(20'000);
BENCHMARK(BM_RoundTripAtOnceTwoCores)->Iterations(20'000);

}  // namespace
}  // namespace handrail::bench
