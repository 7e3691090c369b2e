#include "tests/storm/crowded.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <functional>
#include <memory>

#include "client/api/operator_client.h"
#include "devices/rig/tap.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/random.h"
#include "server/base/realtime.h"
#include "server/link/codec.h"
#include "tests/storm/cell.h"
#include "tests/support/crowd.h"
#include "tests/support/held_file.h"
#include "tests/support/stuck_log.h"
#include "tests/support/udp_relay.h"

namespace handrail::storm {
namespace {

constexpr int kPairs = 10;               // windows without the crowd, and with it
constexpr Nanos kWindow = 10 * kSecond;  // 10 000 ticks, 1400 cycles: p99.9 is among them
constexpr Nanos kSettle = 2 * kSecond;   // until all of the crowd has come
constexpr int kClients = 1000;
constexpr Nanos kPeriod = 200 * kMillisecond;  // of each client: 5000 acts a second
constexpr Nanos kPatience = 20 * kSecond;
constexpr char kSlowScene[] = "slow";
// What is to be shown.
constexpr double kStopIn = 10.0;   // [ms]
constexpr double kGrowsBy = 50.0;  // [us]
// Above the daemons' IO threads, with 70, so that what is on the wire is not kept; and below them.
constexpr int kWirePriority = 75, kOperatorPriority = 60;

double ms(Nanos t) { return static_cast<double>(t) / kMillisecond; }

// The smallest value that so large a share is not above.
double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

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
    if (Status s = start(); !s) return s;
    std::unique_ptr<Crowd> crowd;
    if (out_.crowded) {
      if (Status s = hold_disk(); !s) return s;
      crowd = std::make_unique<Crowd>(cell_.socket(), kClients, kPeriod, random_.bits());
    }
    if (Status s = engage(); !s) return s;
    if (!pause(kSettle)) return Status::ok();
    const Nanos begin = monotonic_now();
    for (int i = 0; i < stops; ++i) {
      if (Status s = drive_and_stop(); !s || interrupted_()) return s;
    }
    while (monotonic_now() < begin + kWindow) {
      if (Status s = drive(); !s || interrupted_()) return s;
      if (!pause(kSecond)) return Status::ok();
    }
    const auto status = order("status: true");
    if (!status) return status.status();
    out_.haptic_us = status->status().loop_lateness_us().p999();
    if (Status s = read_robot(begin); !s) return s;
    if (crowd) out_.acts = crowd->counts().acts;
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
    if (disk_->holds(kPatience) == cell_.pid(Who::kMaster)) return Status::ok();
    return Status::error("the master does not read the scene: " + load_->output());
  }

  Status start() {
    if (Status s = cell_.start(Who::kRig); !s) return s;
    if (Status s = cell_.start(Who::kSlave); !s) return s;
    wire_ = std::make_unique<UdpRelay>(
        cell_.slave_port(),
        [this](bool to_slave, std::span<const std::uint8_t> bytes) { watch_.see(to_slave, bytes); },
        [] { (void)enter_realtime(kWirePriority); });
    cell_.lead_link_through(wire_->port());
    return cell_.start(Who::kMaster);
  }

  Result<pb::Reply> order(const std::string& text) {
    pb::Request request;
    if (!google::protobuf::TextFormat::ParseFromString(text, &request)) {
      return Status::error("no order: " + text);
    }
    return driver_->call(request, kPatience);
  }
  // Again until it is done, since both sides take their time.
  Status order_done(const std::string& text) {
    const Nanos give_up = monotonic_now() + kPatience;
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
    const auto reply = stopper.call(stop, kPatience);
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
  std::unique_ptr<UdpRelay> wire_;
  std::unique_ptr<Child> load_;
  std::unique_ptr<test::HeldFile> disk_;  // after what waits for it
  std::unique_ptr<OperatorClient> driver_ = std::make_unique<OperatorClient>(cell_.socket(), "ada");
  bool (*interrupted_)();
  double way_ = 10.0;  // of the hand, there and back [mm]
};

CrowdedFigures::Times times_of(const std::vector<double>& values) {
  return {values.size(), at_share(values, 0.5), at_share(values, 0.99), at_share(values, 0.999),
          at_share(values, 1.0)};
}

std::string in_words(const CrowdedFigures::Times& t) {
  return fmt::format("median {:.2f}, p99 {:.2f}, p99.9 {:.2f}, worst {:.2f} ms", t.median, t.p99,
                     t.p999, t.worst);
}

std::string in_json(const CrowdedFigures::Times& t) {
  return fmt::format(
      "{{\"count\": {}, \"median\": {:.3f}, \"p99\": {:.3f}, \"p999\": {:.3f}, \"worst\": {:.3f}}}",
      t.count, t.median, t.p99, t.p999, t.worst);
}

// One figure of the windows with the crowd, or without.
std::vector<double> of(const std::vector<CrowdedWindow>& windows, bool crowded,
                       double CrowdedWindow::*figure) {
  std::vector<double> out;
  for (const CrowdedWindow& w : windows) {
    if (w.crowded == crowded) out.push_back(w.*figure);
  }
  return out;
}

bool disk_held(const CrowdedOutcome& outcome) {
  const auto with = [](const CrowdedWindow& w) { return w.crowded; };
  const auto held = [](const CrowdedWindow& w) { return !w.crowded || w.disk_held; };
  return std::any_of(outcome.windows.begin(), outcome.windows.end(), with) &&
         std::all_of(outcome.windows.begin(), outcome.windows.end(), held);
}

double median_growth(const std::vector<CrowdedWindow>& windows, double CrowdedWindow::*figure) {
  const auto without = of(windows, false, figure), with = of(windows, true, figure);
  std::vector<double> grows;
  for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i) {
    grows.push_back(with[i] - without[i]);
  }
  if (grows.empty()) return 0.0;
  std::sort(grows.begin(), grows.end());
  const std::size_t n = grows.size();
  return 0.5 * (grows[(n - 1) / 2] + grows[n / 2]);
}

}  // namespace

CrowdedOutcome run_crowded(const CrowdedOptions& options, bool (*interrupted)(),
                           void (*progress)(int window, int of)) {
  CrowdedOutcome out;
  out.realtime = enter_realtime(kOperatorPriority).fifo;
  Random seeds(options.seed);
  for (int pair = 0; pair < kPairs; ++pair) {
    const int stops = options.stops * (pair + 1) / kPairs - options.stops * pair / kPairs;
    for (const bool crowded : {false, true}) {
      progress(2 * pair + (crowded ? 2 : 1), 2 * kPairs);
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

CrowdedFigures figures_of(const std::vector<CrowdedWindow>& windows) {
  std::vector<double> sent, taken, answered, calm;
  for (const CrowdedWindow& w : windows) {
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    if (!w.crowded) {
      add(calm, w.taken_ms);
      continue;
    }
    add(sent, w.sent_ms);
    add(taken, w.taken_ms);
    add(answered, w.answered_ms);
  }
  CrowdedFigures out;
  out.sent = times_of(sent);
  out.taken = times_of(taken);
  out.answered = times_of(answered);
  out.calm_taken = times_of(calm);
  out.haptic_grows_us = median_growth(windows, &CrowdedWindow::haptic_us);
  out.robot_grows_us = median_growth(windows, &CrowdedWindow::robot_us);
  return out;
}

bool CrowdedFigures::reached() const {
  return taken.count > 0 && taken.p999 <= kStopIn && haptic_grows_us <= kGrowsBy &&
         robot_grows_us <= kGrowsBy;
}

std::string for_people(const CrowdedOutcome& outcome) {
  const CrowdedFigures f = figures_of(outcome.windows);
  const bool held = disk_held(outcome);
  std::string out = fmt::format(
      "{} stops, {} clients, logs into a stopped terminal, a full pipe and a full disk{}; from "
      "before the operator connects\n"
      "  until the stop is on the wire to the slave:   {}\n"
      "  until the slave says on it that it stops:     {}\n"
      "  until the operator is answered:               {}\n"
      "  the same without all that, slave says so:     {}\n",
      f.taken.count, kClients, held ? ", a scene from a disk that does not answer" : "",
      in_words(f.sent), in_words(f.taken), in_words(f.answered), in_words(f.calm_taken));
  const auto loop = [&](const char* what, double CrowdedWindow::*figure, double grows) {
    return fmt::format(
        "  {}: p99.9 without {:.0f} us, with {:.0f} us\n    median difference of {} "
        "pairs of windows: {:+.0f} us\n",
        what, fmt::join(of(outcome.windows, false, figure), " "),
        fmt::join(of(outcome.windows, true, figure), " "), outcome.windows.size() / 2, grows);
  };
  out += loop("haptic ticks late", &CrowdedWindow::haptic_us, f.haptic_grows_us);
  out += loop("robot commands after their cycle began", &CrowdedWindow::robot_us, f.robot_grows_us);
  if (!held) {
    out += "  no disk was slow: only root can hold the scene that the master reads\n";
  }
  if (!outcome.realtime) {
    out += "  this program was granted no real time: what kept it waiting is in these times\n";
  }
  out += fmt::format(
      "{}: p99.9 of the stop at the slave at most {:g} ms, of the loops at most "
      "{:g} us more\n",
      f.reached() ? "reached" : "NOT REACHED", kStopIn, kGrowsBy);
  return out;
}

std::string to_json(const CrowdedOptions& options, const CrowdedOutcome& outcome) {
  const CrowdedFigures f = figures_of(outcome.windows);
  const auto list = [&](bool crowded, double CrowdedWindow::*figure) {
    return fmt::format("[{:.1f}]", fmt::join(of(outcome.windows, crowded, figure), ", "));
  };
  return fmt::format(
      "{{\"seed\": {}, \"clients\": {}, \"slow_disk\": {}, \"realtime\": {}, "
      "\"on_the_wire_ms\": {}, "
      "\"slave_says_ms\": {}, \"answered_ms\": {}, \"slave_says_without_ms\": {}, "
      "\"haptic_p999_us\": {{\"without\": {}, \"with\": {}, \"median_difference\": {:.1f}}}, "
      "\"robot_p999_us\": {{\"without\": {}, \"with\": {}, \"median_difference\": {:.1f}}}, "
      "\"reached\": {}}}\n",
      options.seed, kClients, disk_held(outcome), outcome.realtime, in_json(f.sent),
      in_json(f.taken), in_json(f.answered), in_json(f.calm_taken),
      list(false, &CrowdedWindow::haptic_us), list(true, &CrowdedWindow::haptic_us),
      f.haptic_grows_us, list(false, &CrowdedWindow::robot_us),
      list(true, &CrowdedWindow::robot_us), f.robot_grows_us, f.reached());
}

}  // namespace handrail::storm
