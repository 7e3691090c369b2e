#include "tests/storm/crowded.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>
#include <thread>

#include "client/api/operator_client.h"
#include "devices/rig/tap.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/random.h"
#include "server/base/realtime.h"
#include "server/link/codec.h"
#include "tests/storm/cell.h"
#include "tests/support/crowd.h"
#include "tests/support/datagram_relay.h"
#include "tests/support/held_file.h"
#include "tests/support/stuck_log.h"

namespace handrail::storm {
namespace {

constexpr Nanos kCrowdWindow = 10 * kSecond;   // 10 000 ticks, 1400 cycles: p99.9 is among them
constexpr Nanos kSettle = 2 * kSecond;         // until all of the crowd has come
constexpr Nanos kPeriod = 200 * kMillisecond;  // of each client: 5000 acts a second
constexpr Nanos kCrowdPatience = 20 * kSecond;
constexpr char kSlowScene[] = "slow";
// Above the daemons' IO threads, with 70, so that what is on the wire is not kept; and below them.
constexpr int kWirePriority = 75, kOperatorPriority = 60;
constexpr int kHapticPriority = 85;  // the master's

double ms(Nanos t) { return static_cast<double>(t) / kMillisecond; }

// When master and slave first spoke of their newest stop, as seen on the wire between them.
class StopWatch {
 public:
  void see(bool to_slave, std::span<const std::uint8_t> bytes) {
    if (to_slave) {
      MasterState state;
      if (codec_.decode(bytes, header_, state) == Reject::kNone) note(state.stop_epoch, sent_);
    } else {
      SlaveState state;
      if (codec_.decode(bytes, header_, state) == Reject::kNone) note(state.stop_epoch, taken_);
    }
  }
  // The newest stop, once both have spoken of it.
  bool both(Nanos since, Nanos& sent, Nanos& taken) const {
    sent = sent_.at;
    taken = taken_.at;
    return sent > since && taken > since && sent_.epoch == taken_.epoch;
  }

 private:
  struct Seen {
    std::atomic<std::uint64_t> epoch{0};
    std::atomic<Nanos> at{0};
  };
  static void note(std::uint64_t epoch, Seen& seen) {
    if (seen.epoch == epoch) return;
    seen.at = monotonic_now();
    seen.epoch = epoch;
  }
  Codec codec_;
  DatagramHeader header_;
  Seen sent_, taken_;
};

// A thread that does nothing, as often and with as much right to run as the haptic loop.
class BareLoop {
 public:
  BareLoop() : thread_([this] { run(); }) {}
  ~BareLoop() { end(); }
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;

  // p99.9 of how late its ticks began, from the start to now [us]. Ends it.
  double p999_us() {
    end();
    return to_us(pacer_.lateness().quantile(0.999));
  }

 private:
  static double to_us(Nanos t) { return static_cast<double>(t) / kMicrosecond; }
  void run() {
    (void)enter_realtime(kHapticPriority);
    while (!ends_) {
      sleep_until(pacer_.due());
      pacer_.woke(monotonic_now());
    }
  }
  void end() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::atomic<bool> ends_{false};
  Pacer pacer_{kMillisecond, monotonic_now()};
  std::thread thread_;  // last: it uses the others
};

class Window {
 public:
  Window(int pair, bool crowded, std::uint64_t seed, bool (*interrupted)())
      : random_(seed), cell_(calm(seed), true), interrupted_(interrupted) {
    out_.crowded = crowded;
    for (int i = 0; crowded && i < StuckLog::kKinds; ++i) {
      logs_.push_back(std::make_unique<StuckLog>(StuckLog::Kind((pair + i) % StuckLog::kKinds)));
      cell_.log_to(static_cast<Who>(i), logs_.back()->fd());
    }
  }

  // The error says what went wrong; nothing of it counts then.
  Status run(int stops) {
    for (const auto& log : logs_) {
      if (log->fd() < 0) return Status::error("a log that nobody takes cannot be had here");
    }
    if (Status s = start(); !s) return s;
    BareLoop bare;
    std::unique_ptr<Crowd> crowd;
    if (out_.crowded) {
      if (Status s = hold_disk(); !s) return s;
      crowd = std::make_unique<Crowd>(cell_.socket(), kCrowd, kPeriod, random_.bits());
    }
    if (Status s = engage(); !s) return s;
    if (!pause(kSettle)) return Status::ok();
    const Nanos begin = monotonic_now();
    for (int i = 0; i < stops; ++i) {
      if (Status s = drive_and_stop(); !s || interrupted_()) return s;
    }
    while (monotonic_now() < begin + kCrowdWindow) {
      if (Status s = drive(); !s || interrupted_()) return s;
      if (!pause(kSecond)) return Status::ok();
    }
    const auto status = order("status: true");
    if (!status) return status.status();
    out_.haptic_us = status->status().loop_lateness_us().p999();
    out_.bare_us = bare.p999_us();
    if (Status s = read_robot(begin); !s) return s;
    if (crowd) {
      out_.acts = crowd->counts().acts;
      out_.answers = crowd->counts().answers;
      if (out_.answers < kCrowd) return Status::error("the crowd was not let in");
    }
    crowd.reset();
    if (disk_) disk_->let_go();
    return end();
  }
  const CrowdedWindow& result() const { return out_; }

 private:
  static Sequence calm(std::uint64_t seed) {
    Sequence out;
    out.seed = seed;
    return out;
  }

  // A scene that the master reads from a disk which does not answer.
  Status hold_disk() {
    const std::string scene = fmt::format("name: '{}'\n", kSlowScene);
    disk_ = std::make_unique<test::HeldFile>(
        cell_.folder().write(fmt::format("{}.scene", kSlowScene), scene));
    out_.disk_held = disk_->works();
    if (!out_.disk_held) return Status::ok();
    load_ = std::make_unique<Child>("handrail",
                                    std::vector<std::string>{"scene", "load", kSlowScene, "--as",
                                                             "ada", "--socket", cell_.socket()},
                                    cell_.folder().path() + "/load.out", true);
    if (disk_->holds(kCrowdPatience) == cell_.pid(Who::kMaster)) return Status::ok();
    return Status::error("the master does not read the scene: " + load_->output());
  }

  Status start() {
    if (Status s = cell_.start(Who::kRig); !s) return s;
    if (Status s = cell_.start(Who::kSlave); !s) return s;
    wire_ = std::make_unique<LinkRelay>(
        cell_.link_socket(),
        [this](bool to_slave, std::span<const std::uint8_t> bytes) { watch_.see(to_slave, bytes); },
        [] { (void)enter_realtime(kWirePriority); });
    cell_.lead_link_through(wire_->path());
    return cell_.start(Who::kMaster);
  }

  Result<pb::Reply> order(const std::string& text) {
    pb::Request request;
    if (!google::protobuf::TextFormat::ParseFromString(text, &request)) {
      return Status::error("no order: " + text);
    }
    return driver_->call(request, kCrowdPatience);
  }
  // Again until it is done, since both sides take their time.
  Status order_done(const std::string& text) {
    const Nanos give_up = monotonic_now() + kCrowdPatience;
    for (;;) {
      const auto reply = order(text);
      if (!reply) return reply.status();
      if (reply->done() || interrupted_()) return Status::ok();
      if (monotonic_now() > give_up) return Status::error(text + ": " + reply->reason());
      (void)pause(20 * kMillisecond);
    }
  }
  Status engage() { return order_done("engage: true"); }
  Status drive() {
    way_ = -way_;
    return order_done(fmt::format("hand {{ displacement_mm: [0, {}, 0] duration_s: 0.5 }}", way_));
  }
  // False: interrupted.
  bool pause(Nanos time) {
    const Nanos until = monotonic_now() + time;
    while (monotonic_now() < until && !interrupted_()) {
      sleep_until(std::min(until, monotonic_now() + 50 * kMillisecond));
    }
    return !interrupted_();
  }

  // Somebody else stops the moving arm, on a connection of his own.
  Status drive_and_stop() {
    if (Status s = drive(); !s) return s;
    const double share = random_.uniform();
    if (!pause(static_cast<Nanos>((50.0 + 100.0 * share) * kMillisecond))) return Status::ok();
    pb::Request stop;
    stop.set_stop(true);
    const Nanos since = monotonic_now();
    OperatorClient stopper(cell_.socket(), "eve");
    const auto reply = stopper.call(stop, kCrowdPatience);
    const Nanos answered = monotonic_now();
    if (!reply) return reply.status();
    if (!reply->done()) return Status::error("stop: " + reply->reason());
    Nanos sent = 0, taken = 0;
    if (!watch_.both(since, sent, taken)) return Status::error("no stop was seen on the wire");
    out_.sent_ms.push_back(ms(sent - since));
    out_.taken_ms.push_back(ms(taken - since));
    out_.answered_ms.push_back(ms(answered - since));
    if (Status s = order_done("reset: true"); !s) return s;
    return engage();
  }

  Status read_robot(Nanos since) {
    const auto tap = read_tap(cell_.taps().back());
    if (!tap) return tap.status();
    std::vector<double> came;
    for (const TapRecord& record : tap->records) {
      if (record.at > since && record.has(kTapAccepted)) came.push_back(record.came);
    }
    out_.cycles = came.size();
    out_.robot_us = at_share(std::move(came), 0.999);
    return Status::ok();
  }

  Status end() {
    for (const Who who : {Who::kMaster, Who::kSlave, Who::kRig}) {
      if (!cell_.running(who)) {
        return Status::error(fmt::format("{} ended by itself: {}", name(who), cell_.output(who)));
      }
      cell_.send(who, SIGTERM);
      const int code = cell_.wait_for_end(who);
      if (code != 0) return Status::error(fmt::format("{} ended with {}", name(who), code));
    }
    return Status::ok();
  }

  CrowdedWindow out_;
  Random random_;
  std::vector<std::unique_ptr<StuckLog>> logs_;
  StopWatch watch_;
  Cell cell_;
  std::unique_ptr<LinkRelay> wire_;
  std::unique_ptr<Child> load_;
  std::unique_ptr<test::HeldFile> disk_;  // after what waits for it
  std::unique_ptr<OperatorClient> driver_ = std::make_unique<OperatorClient>(cell_.socket(), "ada");
  bool (*interrupted_)();
  double way_ = 10.0;  // of the hand, there and back [mm]
};

}  // namespace

CrowdedOutcome run_crowded(const CrowdedOptions& options, bool (*interrupted)(),
                           void (*progress)(int window, int of)) {
  CrowdedOutcome out;
  out.realtime = enter_realtime(kOperatorPriority).fifo;
  Random seeds(options.seed);
  for (int pair = 0; pair < options.pairs; ++pair) {
    const int stops =
        options.stops * (pair + 1) / options.pairs - options.stops * pair / options.pairs;
    for (const bool crowded : {false, true}) {
      progress(2 * pair + (crowded ? 2 : 1), 2 * options.pairs);
      Window window(pair, crowded, seeds.bits(), interrupted);
      const Status ran = window.run(stops);
      if (interrupted()) return out;
      if (!ran) {
        out.complete = true;
        out.problem = fmt::format("window {} {} the crowd: {}", pair + 1,
                                  crowded ? "with" : "without", ran.message());
        return out;
      }
      out.windows.push_back(window.result());
    }
  }
  out.complete = true;
  return out;
}

}  // namespace handrail::storm
