#include "server/slave/slave_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio.hpp>

#include "server/base/clock.h"
#include "server/link/pump.h"
#include "server/link/stall_watch.h"
#include "server/link/udp_transport.h"

namespace handrail {

namespace asio = boost::asio;

namespace {

// How often a scene that differs from the master's is looked for again.
constexpr Nanos kSceneRetry = 2 * kSecond;

}  // namespace

struct SlaveServer::Impl {
  Impl(SlaveMailboxes& mailboxes, FtSensor* ft_sensor, SlaveServerOptions opts)
      : boxes(mailboxes), sensor(ft_sensor), options(std::move(opts)) {}

  // The peer's own schedule wakes us, so that every wake-up finds a datagram due.
  void wait_for_tick(Nanos now) {
    const Nanos next = now + (known ? std::min(peer.wait_time(now), kSendPeriod) : kSendPeriod);
    timer.expires_at(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next)));
    timer.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      const Nanos woke = monotonic_now();
      tick(woke);
      if (finished()) return io.stop();
      wait_for_tick(woke);
    });
  }

  void tick(Nanos now) {
    receive(now);
    poll_sensor(now);
    known = boxes.report.take(report) || known;
    if (!known) return;
    log_stall(now);
    SlaveState told = report.state;
    if (scene_missing && told.state == SessionState::kOff) told.reason = Reason::kSceneNotLoaded;
    const std::uint64_t unsendable = peer.snapshot().unsendable;
    pump.send(now, told, report.good_until);
    if (unsendable == 0 && peer.snapshot().unsendable != 0) {
      spdlog::error("own state cannot be sent: {}", describe(peer.last_unsendable()));
    }
  }

  void log_stall(Nanos now) {
    const StallWatch::Change change = stall.step(now, report.good_until);
    if (change == StallWatch::Change::kStalled) {
      spdlog::error("the robot loop stands still: nothing is sent");
    } else if (change == StallWatch::Change::kRunsAgain) {
      spdlog::warn("the robot loop runs again, after {} ms", stall.stood_for() / kMillisecond);
    }
  }

  void receive(Nanos now) {
    if (!pump.receive(now)) return;
    if (peer.snapshot().peer_epoch != peer_epoch) {
      peer_epoch = peer.snapshot().peer_epoch;
      spdlog::info("master connected, session {}", peer_epoch);
    }
    boxes.master.publish({peer.newest(), peer.snapshot()});
    follow_scene(now);
  }

  // While nothing moves, loads our file of the master's scene whenever the two sides differ.
  void follow_scene(Nanos now) {
    const MasterState& master = peer.newest();
    const std::string wanted(text_of(master.scene));
    const SlaveState& state = report.state;
    const bool idle = state.state == SessionState::kOff || state.state == SessionState::kFault;
    if (!differs(master) || !same_scene(master, tried)) scene_missing = false;
    // What was not tried yet need not wait.
    if (!same_scene(master, tried)) next_scene_try = now;
    if (wanted.empty() || !idle || !known || !differs(master) || now < next_scene_try) return;
    next_scene_try = now + kSceneRetry;
    tried = master;
    const auto loaded = options.load_scene(wanted);
    scene_missing = !loaded;
    if (!loaded) {
      if (loaded.message() != scene_problem) {
        spdlog::error("the master's scene '{}' cannot be loaded: {}", wanted, loaded.message());
      }
      scene_problem = loaded.message();
      return;
    }
    scene_problem.clear();
    if (wanted != text_of(state.scene)) spdlog::info("scene '{}', as the master has it", wanted);
    boxes.settings.publish(*loaded);
  }

  bool differs(const MasterState& master) const { return !same_scene(master, report.state); }
  template <typename State>
  static bool same_scene(const MasterState& master, const State& other) {
    const SectionHashes& a = master.hashes;
    const SectionHashes& b = other.hashes;
    return master.scene == other.scene && a.mapping == b.mapping && a.limits == b.limits &&
           a.robot == b.robot;
  }

  void poll_sensor(Nanos now) {
    FtSample sample;
    if (sensor == nullptr || !sensor->poll(now, sample)) return;
    boxes.force.publish({sample.wrench, sample.status == 0, now});
  }

  SlaveMailboxes& boxes;
  FtSensor* sensor;
  SlaveServerOptions options;
  asio::io_context io{1};
  asio::steady_timer timer{io};
  UdpTransport transport{io};
  SlavePeer peer{random_session_id()};
  LinkPump<SlaveState, MasterState> pump{transport, peer};
  SlaveReport report;
  StallWatch stall;
  bool known = false;  // the robot loop has spoken
  Nanos next_scene_try = 0;
  MasterState tried;           // whose scene was looked for last
  std::string scene_problem;   // last one logged
  bool scene_missing = false;  // the last one tried could not be loaded
  std::uint32_t peer_epoch = 0;
  std::function<bool()> finished;
};

SlaveServer::SlaveServer(SlaveMailboxes& boxes, FtSensor* sensor, SlaveServerOptions options)
    : impl_(std::make_unique<Impl>(boxes, sensor, std::move(options))) {}
SlaveServer::~SlaveServer() = default;

Status SlaveServer::open() {
  UdpTransportOptions own;
  own.address = impl_->options.address;
  own.port = impl_->options.port;
  return impl_->transport.open(own);
}

std::uint16_t SlaveServer::port() const { return impl_->transport.port(); }

void SlaveServer::run(std::function<void()> on_signal, std::function<bool()> finished) {
  Impl& impl = *impl_;
  impl.finished = std::move(finished);
  asio::signal_set signals(impl.io, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code& error, int) {
    if (!error) on_signal();
  });
  impl.transport.on_readable([&impl] { impl.receive(monotonic_now()); });
  impl.wait_for_tick(monotonic_now());
  impl.io.run();
  spdlog::info("link: {} datagrams accepted, {} rejected, {} sent", impl.peer.snapshot().accepted,
               impl.peer.snapshot().rejected, impl.peer.snapshot().sent);
}

}  // namespace handrail
