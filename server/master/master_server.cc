#include "server/master/master_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
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

struct MasterServer::Impl {
  Impl(MasterMailboxes& mailboxes, OrderDesk& order_desk, MasterServerOptions opts)
      : boxes(mailboxes), desk(order_desk), options(std::move(opts)) {}

  // The peer's own schedule wakes us, so that every wake-up finds a datagram due.
  void wait_for_tick(Nanos now) {
    const Nanos next =
        now + (desk.report() ? std::min(peer.wait_time(now), kSendPeriod) : kSendPeriod);
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
    desk.tick(now, peer.newest(), peer.snapshot());
    if (!desk.report()) return;
    const HapticReport& report = *desk.report();
    log_change(report.out.link.state, report.out.reason);
    log_stall(now, report.good_until);
    const std::uint64_t unsendable = peer.snapshot().unsendable;
    pump.send(now, report.out.link, report.good_until);
    if (unsendable == 0 && peer.snapshot().unsendable != 0) {
      spdlog::error("own state cannot be sent: {}", describe(peer.last_unsendable()));
    }
  }

  void receive(Nanos now) {
    if (!pump.receive(now)) return;
    if (peer.snapshot().peer_epoch != peer_epoch) {
      peer_epoch = peer.snapshot().peer_epoch;
      spdlog::info("slave connected, session {}", peer_epoch);
    }
    boxes.slave.publish({peer.newest(), peer.snapshot()});
  }

  void log_stall(Nanos now, Nanos good_until) {
    const StallWatch::Change change = stall.step(now, good_until);
    if (change == StallWatch::Change::kStalled) {
      spdlog::error("the haptic loop stands still: nothing is sent, the arm holds");
    } else if (change == StallWatch::Change::kRunsAgain) {
      spdlog::warn("the haptic loop runs again, after {} ms", stall.stood_for() / kMillisecond);
    }
  }

  void log_change(SessionState state, Reason reason) {
    if (state == logged_state) return;
    logged_state = state;
    spdlog::info("session {}{}{}", name_of(state), reason == Reason::kNone ? "" : ": ",
                 reason == Reason::kNone ? "" : describe(reason));
  }

  MasterMailboxes& boxes;
  OrderDesk& desk;
  MasterServerOptions options;
  asio::io_context io{1};
  asio::steady_timer timer{io};
  UdpTransport transport{io};
  MasterPeer peer{random_session_id()};
  LinkPump<MasterState, SlaveState> pump{transport, peer};
  OperatorServer operators{io, desk};
  StallWatch stall;
  std::uint32_t peer_epoch = 0;
  SessionState logged_state = SessionState::kOff;
  std::function<bool()> finished;
};

MasterServer::MasterServer(MasterMailboxes& boxes, OrderDesk& desk, MasterServerOptions options)
    : impl_(std::make_unique<Impl>(boxes, desk, std::move(options))) {}
MasterServer::~MasterServer() = default;

Status MasterServer::open() {
  UdpTransportOptions own;
  own.address = impl_->options.address;
  own.port = impl_->options.port;
  own.peer_address = impl_->options.slave_address;
  own.peer_port = impl_->options.slave_port;
  if (Status opened = impl_->transport.open(own); !opened) return opened;
  return impl_->operators.start(impl_->options.operator_socket);
}

std::uint16_t MasterServer::port() const { return impl_->transport.port(); }

void MasterServer::run(std::function<void()> on_signal, std::function<bool()> finished) {
  Impl& impl = *impl_;
  impl.finished = std::move(finished);
  asio::signal_set signals(impl.io, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code& error, int) {
    if (error) return;
    spdlog::info("told to end: disengaging");
    on_signal();
  });
  impl.transport.on_readable([&impl] { impl.receive(monotonic_now()); });
  impl.wait_for_tick(monotonic_now());
  impl.io.run();
  impl.operators.stop();
  spdlog::info("link: {} datagrams accepted, {} rejected, {} sent", impl.peer.snapshot().accepted,
               impl.peer.snapshot().rejected, impl.peer.snapshot().sent);
}

}  // namespace handrail
