// A daemon's IO thread: datagrams as they come, a tick a millisecond, and signals.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio.hpp>

#include "server/base/clock.h"
#include "server/base/doorbell.h"
#include "server/base/signals.h"
#include "server/link/busy_poll.h"
#include "server/link/leader_watch.h"
#include "server/link/pump.h"
#include "server/link/stall_watch.h"
#include "server/link/transport.h"

namespace handrail {

// One end of the link on a transport of its own, and the thread's clock. Says who connects and when
// the control loop, whose state is sent, stands still. All methods in one thread.
template <typename Local, typename Remote>
class LinkServer {
 public:
  struct Hooks {
    std::function<void(Nanos now)> on_news;  // the peer has said something new
    // A thousand times a second and when the control loop rings; send() from here.
    std::function<void(Nanos now)> on_tick;
    std::function<void()> on_signal;  // of ending_signals()
    std::function<bool()> finished;   // asked after every tick
    // A line for the log; `bad`: somebody should look.
    std::function<void(bool bad, const std::string& line)> say;
  };

  // In what is said: "haptic" of our control loop, "slave" of the other side. `doorbell`: the
  // control loop's, for what must not wait for the next tick. Must outlive the server.
  LinkServer(const char* own_loop, const char* peer_name, const Doorbell& doorbell)
      : own_loop_(own_loop), peer_name_(peer_name), doorbell_(doorbell) {}
  ~LinkServer() {
    if (bell_.is_open()) bell_.release();
  }

  // Opens what `make` makes. The error says what was expected.
  Status open(const TransportMaker& make) {
    boost::system::error_code error = boost::asio::error::no_descriptors;
    if (doorbell_.fd() >= 0) bell_.assign(doorbell_.fd(), error);
    if (error) {
      return Status::error("the " + own_loop_ + " loop cannot wake the link: " + error.message());
    }
    transport_ = make(io_);
    pump_.emplace(*transport_, peer_);
    pump_->keep(tap_);
    return transport_->open();
  }
  // What goes over the link from open() on is left in `tap` too; null: nothing. It outlives this.
  void keep(PacketTap* tap) noexcept { tap_ = tap; }
  // Where the link is; empty until open().
  std::string place() const { return transport_ ? transport_->place() : std::string(); }
  LinkIdentity identity(Nanos now) const {
    return transport_ ? transport_->identity(now) : LinkIdentity();
  }
  // From run() on the thread polls, by BusyPoll's law, instead of sleeping.
  void poll_busily() noexcept { busy_.turn_on(); }
  boost::asio::io_context& io() { return io_; }
  const Remote& newest() const { return peer_.newest(); }
  const LinkSnapshot& snapshot() const { return peer_.snapshot(); }

  // Sends `state` if a datagram is due, until `sent_until`. After `good_until` the loop that made
  // it is said to stand still.
  void send(Nanos now, const Local& state, Nanos sent_until, Nanos good_until) {
    speaking_ = true;
    if (const auto line = stall_.step(now, good_until, own_loop_)) hooks_.say(true, *line);
    const std::uint64_t unsendable = snapshot().unsendable;
    pump_->send(now, state, sent_until);
    if (unsendable == 0 && snapshot().unsendable != 0) {
      hooks_.say(true,
                 std::string("own state cannot be sent: ") + describe(peer_.last_unsendable()));
    }
  }

  // Instead of send(), for one who leads nobody: the other side hears nothing.
  void keep_silent(Nanos now) {
    speaking_ = true;
    peer_.withhold(now);
  }

  // Until `finished` says so. Throws std::bad_alloc where there is no memory for the next tick: who
  // cannot serve a stop must not go on.
  void run(Hooks hooks) {
    hooks_ = std::move(hooks);
    for (const int signal : ending_signals()) signals_.add(signal);
    signals_.async_wait([this](const boost::system::error_code& error, int) {
      if (!error) hooks_.on_signal();
    });
    take_endings();
    transport_->on_say(hooks_.say);
    transport_->on_readable([this] { in_memory([this] { receive(monotonic_now()); }); });
    wait_for_ring();
    // Who asks first may have waited for us, and finds that we know how things stand.
    const Nanos start = monotonic_now();
    tick(start);
    wait_for_tick(start);
    while (!io_.stopped()) {
      if (busy_.polls(monotonic_now())) {
        io_.poll();
      } else {
        io_.run_one();
      }
    }
    const LinkSnapshot& link = snapshot();
    const std::string causes = causes_text(peer_.rejects());
    hooks_.say(false, "link: " + std::to_string(link.accepted) + " datagrams accepted, " +
                          std::to_string(link.rejected) + " rejected" +
                          (causes.empty() ? "" : " (" + causes + ")") + ", " +
                          std::to_string(link.sent) + " sent, " + std::to_string(link.unsendable) +
                          " unsendable");
  }

 private:
  // The peer's own schedule wakes us, so that every wake-up finds a datagram due.
  void wait_for_tick(Nanos now) {
    const Nanos next =
        now + (speaking_ ? std::min(peer_.wait_time(now), kSendPeriod) : kSendPeriod);
    // A span, not a point: the timer's clock stands still while the computer sleeps, ours does not.
    timer_.expires_after(std::chrono::nanoseconds(next - monotonic_now()));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      const Nanos woke = monotonic_now();
      tick(woke);
      if (hooks_.finished()) return io_.stop();
      wait_for_tick(woke);
      rest(woke);
    });
  }

  // What ends the rest of one who polls.
  void rest(Nanos now) {
    if (!busy_.on()) return;
    busy_.ticked(now, snapshot().received_at);
    rest_.expires_after(std::chrono::nanoseconds(BusyPoll::kRest));
    rest_.async_wait([](const boost::system::error_code&) {});
  }

  void wait_for_ring() {
    bell_.async_wait(boost::asio::posix::descriptor_base::wait_read,
                     [this](const boost::system::error_code& error) {
                       if (error) return;
                       if (doorbell_.answer()) tick(monotonic_now());
                       wait_for_ring();
                     });
  }

  void tick(Nanos now) {
    in_memory([this, now] {
      transport_->tick(now);
      receive(now);
      log_leader(now);
      log_version(now);
      hooks_.on_tick(now);
    });
  }

  // What finds no memory is left undone; the next tick comes all the same.
  template <typename F>
  void in_memory(F f) {
    try {
      f();
    } catch (const std::bad_alloc&) {
      if (!std::exchange(said_full_, true)) {
        hooks_.say(true, "no memory left: what needs some is not done until there is");
      }
    }
  }

  void receive(Nanos now) {
    if (!pump_->receive(now)) return;
    if (snapshot().peer_epoch != peer_epoch_) {
      peer_epoch_ = snapshot().peer_epoch;
      hooks_.say(false, peer_name_ + " connected, session " + std::to_string(peer_epoch_));
    }
    hooks_.on_news(now);
  }

  void log_leader(Nanos now) {
    const LinkSnapshot& link = snapshot();
    const LeaderWatch::Change change = leader_.step(link, now);
    if (change == LeaderWatch::Change::kLed) {
      hooks_.say(true, "the " + peer_name_ + " is led by another master (" +
                           leader_text(link.refusal, now - link.refused_at) +
                           "): end that one; until then nothing is obeyed from here");
    } else if (change == LeaderWatch::Change::kAnswers) {
      hooks_.say(false, "the " + peer_name_ + " answers this master now");
    }
  }

  void log_version(Nanos now) {
    const int other = snapshot().other_version(now);
    if (other == std::exchange(said_version_, other) || other == 0) return;
    hooks_.say(true, "the " + peer_name_ + " speaks wire version " + std::to_string(other) +
                         ", this program " + std::to_string(kWireVersion) +
                         ": nothing of it is obeyed; install the same Handrail on both sides");
  }

  const std::string own_loop_, peer_name_;
  const Doorbell& doorbell_;
  boost::asio::io_context io_{1};
  boost::asio::steady_timer timer_{io_}, rest_{io_};
  boost::asio::signal_set signals_{io_};  // needs descriptors: had before anybody is told READY
  boost::asio::posix::stream_descriptor bell_{io_};  // the doorbell's, not ours to close
  std::unique_ptr<ServedTransport> transport_;       // null until open()
  LinkPeer<Local, Remote> peer_{random_session_id()};
  std::optional<LinkPump<Local, Remote>> pump_;
  PacketTap* tap_ = nullptr;
  StallWatch stall_;
  LeaderWatch leader_;
  BusyPoll busy_;
  Hooks hooks_;
  std::uint32_t peer_epoch_ = 0;
  bool speaking_ = false;
  bool said_full_ = false;
  int said_version_ = 0;  // of the other side; 0: ours, or not heard
};

}  // namespace handrail
