#include "devices/rig/rig_server.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <spdlog/spdlog.h>
#include <boost/asio.hpp>

#include "devices/melfa/mxt_packet.h"
#include "devices/rig/switches_server.h"
#include "devices/rig/tap.h"
#include "server/base/clock.h"
#include "server/base/signals.h"
#include "server/base/units.h"

namespace handrail {

namespace asio = boost::asio;
using asio::ip::udp;

namespace {

// From one number: address and port.
udp::endpoint endpoint_of(PeerId id) {
  return {asio::ip::address_v4(static_cast<std::uint32_t>(id >> 16)),
          static_cast<std::uint16_t>(id)};
}

void log_alarm(const Alarm& alarm) {
  if (alarm.kind == AlarmKind::kNone) {
    spdlog::info("alarm reset");
  } else if (alarm.joint > 0) {
    spdlog::warn("alarm: J{} {:.4f} deg: {}; silent until reset", alarm.joint, alarm.value / kDeg,
                 describe(alarm.kind));
  } else {
    spdlog::warn("alarm: {} ({}); silent until reset", describe(alarm.kind), alarm.value);
  }
}

}  // namespace

struct RigServer::Impl {
  struct Datagram {
    Nanos at = 0;  // when it came, though nobody looked
    PeerId from = 0;
    std::size_t size = 0;
    std::array<std::uint8_t, 512> bytes{};
    std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
  };
  // One bound socket and what was read from it: datagrams[taken .. waiting) are yet to be
  // delivered.
  struct Port {
    udp::socket socket;
    std::array<Datagram, 64> datagrams{};
    std::size_t waiting = 0, taken = 0;
  };

  explicit Impl(const RigOptions& rig_options) : options(rig_options) {}

  Status bind(Port& port, const char* what, const udp::endpoint& at) {
    boost::system::error_code error;
    port.socket.open(at.protocol(), error);
    if (!error) port.socket.bind(at, error);
    const int on = 1;
    if (!error)
      ::setsockopt(port.socket.native_handle(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
    if (!error) return Status::ok();
    boost::system::error_code ignored;
    port.socket.close(ignored);
    const std::string port_text =
        std::string(what) + " port " + at.address().to_string() + ":" + std::to_string(at.port());
    if (error != asio::error::address_in_use) {
      return Status::error(port_text + ": " + error.message());
    }
    return Status::error(port_text + " is in use, likely by a handrail-rig that still runs: end " +
                         "it, or set " + what + "_port to another");
  }

  void receive(Port& port) {
    port.socket.async_wait(udp::socket::wait_read,
                           [this, &port](const boost::system::error_code& error) {
                             if (error) return;
                             pump();
                             receive(port);
                           });
  }

  // Reads what waits on a port.
  void drain(Port& port) {
    port.waiting = port.taken = 0;
    while (port.waiting < port.datagrams.size() && read(port, port.datagrams[port.waiting])) {
      ++port.waiting;
    }
  }

  bool read(Port& port, Datagram& out) {
    sockaddr_in from{};
    iovec bytes{out.bytes.data(), out.bytes.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control;
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof(from);
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    ssize_t size = -1;
    // Any error but "nothing there" is a datagram of ours that found nobody.
    do size = ::recvmsg(port.socket.native_handle(), &message, MSG_DONTWAIT);
    while (size < 0 && errno != EAGAIN);
    if (size < 0) return false;
    out.size = static_cast<std::size_t>(size);
    out.from = (PeerId{ntohl(from.sin_addr.s_addr)} << 16) | ntohs(from.sin_port);
    const Nanos now = monotonic_now();
    out.at = now;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec stamp{}, wall{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof(stamp));
      ::clock_gettime(CLOCK_REALTIME, &wall);
      out.at = now - std::max<Nanos>(0, nanos(wall) - nanos(stamp));
    }
    return true;
  }
  static Nanos nanos(const timespec& t) { return t.tv_sec * kSecond + t.tv_nsec; }

  // What came until `until`, to whom it is for.
  void deliver_until(Nanos until) {
    const auto due = [&](Port& port) {
      return port.taken < port.waiting && port.datagrams[port.taken].at <= until;
    };
    for (; due(robot); ++robot.taken) {
      const Datagram& in = robot.datagrams[robot.taken];
      if (cable_out || in.at <= away_until) {
        rig->controller().missed(in.span());
      } else {
        if (is_mxt_move(in.span())) robot_came = in.at;
        rig->controller().on_datagram(in.span(), in.from);
      }
    }
    for (; due(sensor); ++sensor.taken) {
      const Datagram& in = sensor.datagrams[sensor.taken];
      if (!cable_out && in.at > away_until) rig->sensor().on_datagram(in.span(), in.from);
    }
  }

  void send(Port& port, PeerId to, std::span<const std::uint8_t> bytes) {
    if (cable_out) return;
    boost::system::error_code ignored;  // a datagram the system refuses is a lost one
    port.socket.send_to(asio::buffer(bytes.data(), bytes.size()), endpoint_of(to), 0, ignored);
  }

  // Runs everything due and passes on what was sent. However late, a cycle gets the datagrams that
  // came before its time and no others; what came for cycles that are left out nobody hears.
  void pump() {
    for (;;) {
      // Asked before every cycle, and read after that: the program may be paused anywhere.
      const Nanos now = monotonic_now();
      for (Port* port : {&robot, &sensor}) {
        if (port->taken == port->waiting) drain(*port);
      }
      if (now - rig->next() > Rig::kPatience) away_until = now;
      deliver_until(std::max(rig->next(), away_until));
      if (feed != nullptr) feed->serve(*rig);
      switches.update(now, rig->controller());
      const RigEvent event = rig->step(now);
      if (event == RigEvent::kNone) break;
      if (event == RigEvent::kControl) {
        if (tap.is_open()) {
          tap.add(rig->controller(), rig->controlled_at(), robot_came, cable_out);
        }
        for (const auto& reply : rig->controller().replies()) send(robot, reply.to, reply.bytes());
        log_changes();
      } else {
        if (feed != nullptr) feed->tell(*rig);
        if (const auto& record = rig->sensor().record()) {
          send(sensor, record->to, record->bytes);
        }
      }
    }
  }

  void log_changes() {
    const Controller& controller = rig->controller();
    if (controller.alarm().kind != alarm) log_alarm(controller.alarm());
    alarm = controller.alarm().kind;
    if (controller.session() == session) return;
    session = controller.session();
    if (session) {
      const udp::endpoint peer = endpoint_of(*session);
      spdlog::info("external control by {}:{}", peer.address().to_string(), peer.port());
    } else {
      spdlog::info("external control ended; arm holds");
    }
  }

  void wake_at_next() {
    timer.expires_after(std::chrono::nanoseconds(rig->next() - monotonic_now()));
    timer.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      pump();
      wake_at_next();
    });
  }

  void wait_for_signal() {
    signals.async_wait([this](const boost::system::error_code& error, int signal) {
      if (error) return;
      switch (signal) {
        case SIGUSR1: rig->controller().reset_alarm(); break;
        case SIGUSR2:
          cable_out = !cable_out;
          spdlog::info("cables {}", cable_out ? "out" : "in again");
          break;
        default: return io.stop();
      }
      wait_for_signal();
    });
  }

  // An order at the controller's switches; one at a cable that is out nobody hears.
  std::string order(std::string_view text, PeerId peer) {
    if (cable_out || !rig) return {};
    return switches.answer(text, peer, monotonic_now(), rig->controller());
  }

  RigOptions options;
  Switches switches{options.switches};
  asio::io_context io{1};
  Port robot{udp::socket(io)};
  Port sensor{udp::socket(io)};
  asio::steady_timer timer{io};
  asio::signal_set signals{io};
  std::optional<Rig> rig;
  AlarmKind alarm = AlarmKind::kNone;
  std::optional<PeerId> session;
  bool cable_out = false;
  Nanos away_until = std::numeric_limits<Nanos>::min();  // what came before nobody hears
  Nanos robot_came = 0;                                  // the newest command to move
  Tap tap;
  RigFeed* feed = nullptr;
  SwitchesServer commands{io,
                          {[this](std::string_view text, PeerId peer) { return order(text, peer); },
                           [this](PeerId peer) { switches.left(peer); }}};
};

RigServer::RigServer(const RigOptions& options) : impl_(std::make_unique<Impl>(options)) {}
RigServer::~RigServer() = default;

Status RigServer::open(const std::string& address, std::uint16_t robot_port,
                       std::uint16_t sensor_port) {
  boost::system::error_code error;
  const auto ip = asio::ip::make_address_v4(address, error);
  if (error) {
    return Status::error("address '" + address + "': expected an IPv4 address like 127.0.0.1");
  }
  if (Status s = impl_->bind(impl_->robot, "robot", {ip, robot_port}); !s) return s;
  return impl_->bind(impl_->sensor, "sensor", {ip, sensor_port});
}

Status RigServer::open_switches(const std::string& address, std::uint16_t port) {
  return impl_->commands.open(address, port);
}

std::uint16_t RigServer::command_port() const { return impl_->commands.port(); }

void RigServer::tell(RigFeed& feed) { impl_->feed = &feed; }

Status RigServer::open_tap(const std::string& path) {
  return impl_->tap.open(path, impl_->options.controller.period);
}

std::uint16_t RigServer::robot_port() const { return impl_->robot.socket.local_endpoint().port(); }
std::uint16_t RigServer::sensor_port() const {
  return impl_->sensor.socket.local_endpoint().port();
}

void RigServer::handle_signals() {
  for (const int signal : ending_signals()) impl_->signals.add(signal);
  for (const int signal : {SIGUSR1, SIGUSR2}) impl_->signals.add(signal);
  impl_->wait_for_signal();
}

void RigServer::run() {
  Impl& impl = *impl_;
  impl.rig.emplace(impl.options, monotonic_now());
  impl.receive(impl.robot);
  impl.receive(impl.sensor);
  impl.wake_at_next();
  impl.io.run();
}

void RigServer::stop() { impl_->io.stop(); }

void RigServer::post(std::function<void(Rig&)> f) {
  asio::post(impl_->io, [this, f = std::move(f)] { f(*impl_->rig); });
}

}  // namespace handrail
