// Rows of programs that end, stand still or are starved, and of the slave's stop switch.
#include <fcntl.h>
#include <linux/input.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "server/base/clock.h"
#include "server/model/rv2a_limits.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

// Joint speed of the targets around a moment, the largest of any joint as a share of its limit.
double speed_at(const TapFile& tap, Nanos at) {
  double out = 0.0;
  for (std::size_t i = 1; i < tap.records.size(); ++i) {
    const TapRecord &r = tap.records[i], &before = tap.records[i - 1];
    if (r.at < at - 3 * tap.period || r.at > at + tap.period) continue;
    for (int k = 0; k < kJoints; ++k) {
      const auto joint = static_cast<std::size_t>(k);
      const double speed =
          std::abs(r.target[joint] - before.target[joint]) / to_seconds(tap.period);
      out = std::max(out, speed / rv2a_limits().max_speed[k]);
    }
  }
  return out;
}

// When the last target that moved the arm came, in the `within` after `at`; `at`: none did.
Nanos last_moved(const TapFile& tap, Nanos at, Nanos within) {
  Nanos out = at;
  for (std::size_t i = 1; i < tap.records.size(); ++i) {
    const TapRecord& r = tap.records[i];
    if (r.at > at && r.at < at + within && r.target != tap.records[i - 1].target) out = r.at;
  }
  return out;
}

// The arm at full speed: somewhere in a dash.
void get_going(Bed& bed) {
  bed.drive(300 * kMillisecond);
  bed.dash();
  bed.wait(from_seconds(0.10 + 0.12 * bed.random().uniform()));
}

// What is done to the master in turn.
enum class Blow { kStop, kKill, kFault };

struct Struck {
  Blow blow = Blow::kStop;
  Nanos at = 0, span = 0;
};

// Strikes, and leaves the bed as it was before.
Struck strike(Trial& trial, Bed& bed, int number, Nanos longest) {
  constexpr double kShortest = 0.005;  // [s]
  Struck out;
  out.blow = number % 4 == 1 ? Blow::kKill : number % 8 == 3 ? Blow::kFault : Blow::kStop;
  const double share = bed.random().uniform();
  out.span = from_seconds(kShortest * std::pow(to_seconds(longest) / kShortest, share));
  get_going(bed);
  out.at = monotonic_now();
  if (out.blow == Blow::kStop) {
    bed.signal(Who::kMaster, "STOP");
    bed.wait(out.span);
    bed.signal(Who::kMaster, "CONT");
    // Nobody engages: what was queued, and what the master still wants, must not move the arm.
    bed.wait(700 * kMillisecond);
    if (out.span > 300 * kMillisecond) {
      trial.check(bed.over() || !bed.led(), "led after a long pause without an operator");
    }
  } else {
    bed.signal(Who::kMaster, out.blow == Blow::kKill ? "KILL" : "SEGV");
    bed.wait(500 * kMillisecond);
    if (const Status started = bed.start(Who::kMaster); !started) bed.problem(started.message());
    bed.wait(200 * kMillisecond);
  }
  if (!bed.led() && !bed.engage()) bed.problem("cannot be engaged again");
  return out;
}

}  // namespace

RowResult p1(const RowRun& run) {
  Trial trial(run,
              "the master at full speed: SIGSTOP for 5 ms to 10 s (quick: 1 s), SIGKILL, SIGSEGV",
              "0 old commands after SIGCONT, nothing moves until engage");
  const int blows = run.full ? 200 : 8, of_a_bed = 40;
  int done = 0, after_long = 0, kills = 0;
  std::vector<double> speeds;
  while (done < blows && !trial.over()) {
    auto bed = trial.bed();
    if (!bed) return trial.result();
    std::vector<Struck> all;
    for (int i = 0; i < of_a_bed && done < blows && !bed->over(); ++i, ++done) {
      all.push_back(strike(trial, *bed, done, run.full ? 10 * kSecond : kSecond));
      if (all.back().blow != Blow::kStop)
        ++kills;
      else if (all.back().span > 200 * kMillisecond)
        ++after_long;
    }
    const auto tap = handrail::read_tap(bed->tap());
    const BedVerdict verdict = trial.end(std::move(bed));
    judge_acceptance(trial, verdict);
    for (const Struck& one : all) {
      if (tap) speeds.push_back(speed_at(*tap, one.at));
    }
  }
  std::sort(speeds.begin(), speeds.end());
  const double median = speeds.empty() ? 0.0 : speeds[speeds.size() / 2];
  trial.measure(
      fmt::format("{} blows, {} of them ends, {} pauses over 200 ms; joint speed then {:.2f} "
                  "of the limit (median), {:.2f} at most",
                  done, kills, after_long, median, speeds.empty() ? 0.0 : speeds.back()));
  trial.check(trial.over() || median > 0.1, "the arm was not in motion");
  return trial.result();
}

RowResult p2(const RowRun& run) {
  constexpr Nanos kLastTarget = 30 * kMillisecond;
  constexpr Nanos kShown = 100 * kMillisecond;
  Trial trial(
      run, "the slave killed at full speed, and started again",
      "no target 30 ms later; the master shows it within 100 ms; the slave comes up stopped");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  std::vector<Nanos> kills;
  Nanos shown_worst = 0;
  for (int i = 0; i < (run.full ? 50 : 4) && !bed->over(); ++i) {
    get_going(*bed);
    kills.push_back(monotonic_now());
    bed->signal(Who::kSlave, "KILL");
    bed->must_stop(monotonic_now());
    Nanos shown = kForever;
    while (shown == kForever && monotonic_now() < kills.back() + 2 * kSecond) {
      const auto now = bed->status();
      if (now && (now->state() != "engaged" || now->packet_age_ms() > 20.0))
        shown = monotonic_now();
    }
    shown_worst = std::max(shown_worst, shown - kills.back());
    bed->wait(300 * kMillisecond);
    if (const Status started = bed->start(Who::kSlave); !started) bed->problem(started.message());
    trial.check(bed->over() || bed->connected(5 * kSecond), "not connected again");
    bed->wait(kSecond);
    const auto now = bed->status();
    trial.check(bed->over() || (now && now->slave_state() != "engaged"), "comes up engaged");
    if (!bed->engage()) bed->problem("cannot be engaged again");
  }
  const auto tap = handrail::read_tap(bed->tap());
  const BedVerdict verdict = trial.end(std::move(bed));
  Nanos slowest = 0;
  for (const Nanos at : kills) {
    if (tap) slowest = std::max(slowest, last_moved(*tap, at, 300 * kMillisecond) - at);
  }
  const Nanos late = verdict.link.lateness;
  trial.measure(fmt::format("{} kills: last target after {:.1f} ms, shown after {:.1f} ms at most",
                            kills.size(), in_ms(slowest), in_ms(shown_worst)));
  trial.check(slowest <= kLastTarget + late, "a target came later");
  trial.check(trial.over() || shown_worst <= kShown + late, "shown later");
  return trial.result();
}

RowResult p3(const RowRun& run) {
  Trial trial(
      run, "command lines killed: that watch, and that hold an engagement",
      "no gap over 20 ms from those that watch; the arm rests half a second after one that held");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  const std::string socket = bed->folder() + "/operator/operator.sock";
  const std::string cli = fmt::format("exec {}/handrail --socket {} ", HANDRAIL_BIN_DIR, socket);
  const int times = run.full ? 50 : 8;
  for (int i = 0; i < times && !bed->over(); ++i) {
    const std::string name = fmt::format("watch{}", i);
    if (const Status ran = bed->run("near", name, cli + "status --watch"); !ran) {
      bed->problem(ran.message());
    }
    bed->drive(200 * kMillisecond);
    if (const auto sent = bed->emulator("signal near " + name + " KILL"); !sent) {
      bed->problem(sent.message() + ": " + bed->printed("near", name));
    }
    bed->drive(100 * kMillisecond);
  }
  const BedVerdict watched = trial.end(std::move(bed));
  judge_acceptance(trial, watched);
  trial.measure(
      fmt::format("{} watching killed: {} gaps beside the machine's", times, watched.link.trips));
  trial.check(watched.link.trips == 0, "a gap");
  // The engagement of one that holds it ends with it.
  BedOptions options;
  options.master_config = "presence: HOLD";
  bed = trial.bed(options, true);
  if (!bed) return trial.result();
  for (int i = 0; i < (run.full ? 20 : 3) && !bed->over(); ++i) {
    const std::string name = fmt::format("hold{}", i);
    const std::string line =
        fmt::format("exec {}/handrail --socket {}/operator/operator.sock engage --hold",
                    HANDRAIL_BIN_DIR, bed->folder());
    if (!bed->engage_by(name, line)) {
      bed->problem("cannot be engaged by one that holds: " + bed->printed("near", name));
      break;
    }
    get_going(*bed);
    (void)bed->emulator("signal near " + name + " KILL");
    // Unheard for 200 ms the master's command stands still, and the arm comes up to it.
    bed->must_stop(monotonic_now() + 500 * kMillisecond);
    bed->wait(kSecond);
    trial.check(bed->over() || !bed->led(), "led by nobody");
  }
  trial.measure("and some that held");
  judge_acceptance(trial, trial.end(std::move(bed)));
  return trial.result();
}

RowResult p4(const RowRun& run) {
  Trial trial(run, "eight programs that never rest; daemons with real time, and refused it",
              "with it: engaged; refused: one warning, and engaged or told why not; overruns are "
              "counted");
  for (const bool refused : {false, true}) {
    BedOptions options;
    if (refused) options.master = options.slave = "setpriv --bounding-set -sys_nice";
    options.real_time = !refused;
    auto bed = trial.bed(options, true);
    if (!bed) return trial.result();
    for (const char* side : {"near", "far"}) {
      for (int i = 0; i < 4; ++i) {
        (void)bed->run(side, fmt::format("busy{}", i), "while :; do :; done");
      }
    }
    const bool engaged = bed->engage();
    const std::string told = bed->engage_said();
    const bool real_time =
        bed->printed(Who::kMaster).find("ordinary scheduling") == std::string::npos;
    trial.check(trial.over() || engaged || (!real_time && !told.empty()),
                "not engaged, though in real time, or without a word: " + told);
    std::uint64_t overruns = 0, ticks = 0;
    double late = 0.0;
    bed->drive(run.full ? 60 * kSecond : 5 * kSecond, [&](const pb::Status& s) {
      overruns = s.overruns();
      ticks = s.ticks();
      late = s.loop_lateness_us().max();
    });
    const std::string log = bed->printed(Who::kMaster);
    const BedVerdict verdict = trial.end(std::move(bed));
    judge_acceptance(trial, verdict);
    trial.measure(
        fmt::format("real time {}: {}; {} overruns of {} ticks, worst {:.1f} ms, {} gaps of 20 "
                    "to 200 ms, {} longer",
                    real_time ? "granted" : "refused", engaged ? "engaged" : "not engaged, " + told,
                    overruns, ticks, 1e-3 * late, verdict.link.short_gaps, verdict.link.long_gaps));
    trial.check(trial.over() || (late < 1000.0) == (overruns == 0), "overruns are not counted");
    const std::size_t first = log.find("[warning] not in real time");
    const bool warned = first != log.npos,
               again = log.find("not in real time", first + 20) != log.npos;
    trial.check(trial.over() || warned == !real_time, "warned otherwise than it was granted");
    trial.check(!warned || !again, "warned more than once");
  }
  return trial.result();
}

namespace {

// A FIFO that the slave takes for a foot switch (tests/support/made_up_switch.cc).
class FootSwitch {
 public:
  ~FootSwitch() { unplug(); }

  Status plug(const std::string& folder) {
    path_ = folder + "/foot.switch";
    // Our end for both ways: with a reader of its own it is there before the slave comes.
    if (::mkfifo(path_.c_str(), 0600) == 0) fd_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    return fd_ >= 0 ? Status::ok() : Status::error("no FIFO at " + path_);
  }
  void unplug() {
    ::unlink(path_.c_str());
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  bool key(bool down) const {
    std::array<input_event, 2> report{};
    report[0].type = EV_KEY;
    report[0].code = KEY_B;
    report[0].value = down ? 1 : 0;
    return ::write(fd_, report.data(), sizeof report) == static_cast<ssize_t>(sizeof report);
  }

 private:
  std::string path_;
  int fd_ = -1;
};

enum class Foot { kDown, kUnplugged, kTouched };

// One stop in motion; the arm may not be led before the switch is as it was, and then is. How long
// the targets still moved.
Nanos stop_by_foot(Trial& trial, Bed& bed, FootSwitch& foot, Foot what) {
  constexpr Nanos kInVain = 1500 * kMillisecond;
  const char* const name = what == Foot::kDown        ? "pressed"
                           : what == Foot::kUnplugged ? "unplugged"
                                                      : "touched";
  get_going(bed);
  const Nanos at = monotonic_now();
  bool done = true;
  if (what == Foot::kUnplugged) {
    foot.unplug();
  } else {
    done = foot.key(true) && (what == Foot::kDown || foot.key(false));
  }
  trial.check(done, "the FIFO takes no event");
  bed.must_stop(at);
  bed.wait(600 * kMillisecond);
  const auto tap = handrail::read_tap(bed.tap());
  const Nanos took = tap ? last_moved(*tap, at, 600 * kMillisecond) - at : 0;
  const auto now = bed.status();
  trial.check(bed.over() || (now && now->slave_state() == "fault"),
              fmt::format("{}: the slave does not hold a stop", name));
  trial.check(bed.over() || (now && now->slave_reason() == "the stop circuit is open"),
              fmt::format("{}: the slave says '{}'", name, now ? now->slave_reason() : ""));
  if (what != Foot::kTouched) {
    trial.check(!bed.engage(kInVain), fmt::format("engaged while {}", name));
  }
  if (what == Foot::kDown) trial.check(foot.key(false), "the FIFO takes no event");
  if (what == Foot::kUnplugged) {
    if (const Status plugged = foot.plug(bed.folder()); !plugged) bed.problem(plugged.message());
  }
  trial.check(bed.over() || bed.engage(), fmt::format("cannot be engaged after {}", name));
  return took;
}

}  // namespace

RowResult s4(const RowRun& run) {
  Trial trial(run,
              "the foot switch pressed, pulled out and touched for less than a cycle, in motion",
              "the arm stops as within its bound of a stop, cannot be engaged while it is so, and "
              "needs a reset");
  FootSwitch foot;
  BedOptions options;
  options.slave = "env LD_PRELOAD=" MADE_UP_SWITCH;
  options.slave_config =
      fmt::format("stop_switch {{ device: 'FOLDER/foot.switch' key: {} }}", KEY_B);
  options.prepare = [&foot](const std::string& folder) { return foot.plug(folder); };
  auto bed = trial.bed(options);
  if (!bed) return trial.result();
  Nanos longest = 0;
  const int rounds = run.full ? 33 : 2;
  for (int i = 0; i < rounds && !bed->over(); ++i) {
    for (const Foot what : {Foot::kDown, Foot::kUnplugged, Foot::kTouched}) {
      longest = std::max(longest, stop_by_foot(trial, *bed, foot, what));
    }
  }
  judge_acceptance(trial, trial.end(std::move(bed)));
  trial.measure(fmt::format("{} stops, the last moving target up to {:.1f} ms after", 3 * rounds,
                            in_ms(longest)));
  trial.check(trial.over() || longest > 0, "the arm never moved when it was stopped");
  return trial.result();
}

}  // namespace handrail::faults::rows
