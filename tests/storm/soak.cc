#include "tests/storm/soak.h"

#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "server/base/clock.h"
#include "server/base/random.h"

namespace handrail::storm {
namespace {

constexpr Who kPrograms[] = {Who::kRig, Who::kSlave, Who::kMaster};
constexpr Nanos kVisits = kSecond;       // between clients
constexpr Nanos kSample = 15 * kSecond;  // of memory: 40 in ten minutes, 5760 in a day
constexpr Nanos kTell = 30 * kSecond;
// Until every buffer has once been as large as it gets; of a short run a quarter.
constexpr Nanos kWarmUp = 60 * kSecond;
constexpr int kActsAMinute = 120;  // more than there is time for
constexpr int kClients = 6;        // that come at once

double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

Nanos seconds(double value) { return static_cast<Nanos>(value * 1e9); }

// Nothing that restarts a program: what it holds would be gone.
Sequence soak_sequence(std::uint64_t seed, double minutes) {
  Random random(seed);
  Sequence out;
  out.seed = seed;
  out.loss = 0.02;
  const int acts = static_cast<int>(std::ceil(minutes * kActsAMinute));
  for (int i = 0; i < acts; ++i) {
    Act act;
    act.after = seconds(between(random, 0.2, 3.0));
    act.recover = true;
    const double kind = random.uniform();
    if (kind < 0.5) {
      act.what = What::kPause;
      act.who = static_cast<Who>(4.0 * random.uniform());
      act.lasts = seconds(0.005 * std::pow(400.0, random.uniform()));  // 5 ms to 2 s
    } else if (kind < 0.75) {
      act.what = What::kUnplug;
      act.who = Who::kRig;
      act.lasts = seconds(between(random, 0.03, 1.6));
    } else {
      act.what = What::kStop;
      act.who = Who::kMaster;
    }
    out.acts.push_back(act);
  }
  return out;
}

double resident_mib(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  double all = 0.0, resident = 0.0;
  file >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

// Comes, sends `bytes`, and goes. False: it was not let in.
bool visit(const std::string& socket, const std::string& bytes) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socket.c_str(), sizeof address.sun_path - 1);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return false;
  const bool let_in =
      ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (let_in) (void)::send(fd, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  ::close(fd);
  return let_in;
}

// The bool (*)() of a run has nobody to ask but this.
struct Until {
  Nanos end = 0;
  bool (*interrupted)() = nullptr;
} until;
bool over() { return monotonic_now() >= until.end || until.interrupted(); }

class Watch {
 public:
  Watch(std::uint64_t seed, double minutes, const std::function<void(const std::string&)>& say)
      : start_(monotonic_now()),
        warm_at_(start_ + std::min(kWarmUp, seconds(minutes * 60.0 / 4.0))),
        minutes_(minutes),
        random_(seed + 7),
        say_(say) {}

  void look(const Cell& cell) {
    const Nanos now = monotonic_now();
    if (now >= next_visit_ && !cell.paused(Who::kMaster)) {
      next_visit_ = now + kVisits;
      crowd(cell.socket());
    }
    if (now < next_sample_) return;
    next_sample_ = now + kSample;
    std::array<double, 3> mib{};
    for (const Who who : kPrograms) mib[index(who)] = resident_mib(cell.pid(who));
    if (now >= warm_at_) {
      hours_.push_back(to_seconds(now - start_) / 3600.0);
      for (const Who who : kPrograms) mib_[index(who)].push_back(mib[index(who)]);
    }
    if (now < next_line_) return;
    next_line_ = now + kTell;
    say_(fmt::format("soak: {:.1f} of {:g} min; rig {:.1f}, slave {:.1f}, master {:.1f} MiB",
                     to_seconds(now - start_) / 60.0, minutes_, mib[0], mib[1], mib[2]));
  }

  void result(SoakOutcome& out) const {
    out.clients = clients_;
    if (hours_.empty()) return;
    out.minutes = 60.0 * (hours_.back() - hours_.front());
    for (std::size_t i = 0; i < mib_.size(); ++i) {
      out.growth[i] = {mib_[i].front(), mib_[i].back(),
                       *std::max_element(mib_[i].begin(), mib_[i].end()),
                       robust_slope(hours_, mib_[i])};
    }
  }

 private:
  static std::size_t index(Who who) { return static_cast<std::size_t>(who); }

  void crowd(const std::string& socket) {
    const std::string status("\x02\0\0\0\x08\x01", 6);  // `status: true` in its frame
    for (int i = 0; i < kClients; ++i) {
      const double kind = random_.uniform();
      std::string garbage;
      for (int k = 0; k < 40; ++k) garbage += static_cast<char>(256.0 * random_.uniform());
      clients_ += visit(socket, kind < 0.4 ? status : kind < 0.7 ? status.substr(0, 3) : garbage);
    }
  }

  const Nanos start_, warm_at_;
  const double minutes_;
  Random random_;
  const std::function<void(const std::string&)>& say_;
  Nanos next_visit_ = 0, next_sample_ = 0, next_line_ = 0;
  std::uint64_t clients_ = 0;
  std::vector<double> hours_;
  std::array<std::vector<double>, 3> mib_;
};

}  // namespace

SoakOutcome run_soak(
    std::uint64_t seed, double minutes, bool (*interrupted)(),
    const std::function<void(const std::string&)>& say,
    const std::function<void(const Sequence&, const Outcome&, const Run&)>& violated) {
  until = {monotonic_now() + seconds(60.0 * minutes), interrupted};
  Watch watch(seed, minutes, say);
  const Sequence sequence = soak_sequence(seed, minutes);
  Run run(sequence, over, [&watch](const Cell& cell) { watch.look(cell); });
  const Outcome outcome = run.go();
  if (!outcome.violations.empty()) violated(sequence, outcome, run);
  SoakOutcome out;
  out.complete = !interrupted();
  watch.result(out);
  for (const Violation& v : outcome.violations) {
    out.violations.push_back(fmt::format("{:.1f} s: {}", to_seconds(v.at - outcome.start), v.what));
  }
  return out;
}

bool grows(const SoakOutcome& outcome) {
  return std::any_of(outcome.growth.begin(), outcome.growth.end(),
                     [](const Growth& g) { return g.slope.value > kMostGrowth; });
}

std::string for_people(const SoakOutcome& outcome) {
  std::string out = fmt::format("{:<8}{:>10}{:>10}{:>10}{:>12}{:>22}\n", "[MiB]", "first", "last",
                                "largest", "an hour", "95 % of it");
  const Who* worst = &kPrograms[0];
  const auto of = [&](Who who) { return outcome.growth[static_cast<std::size_t>(who)]; };
  for (const Who& who : kPrograms) {
    const Growth g = of(who);
    if (g.slope.value > of(*worst).slope.value) worst = &who;
    out += fmt::format("{:<8}{:>10.2f}{:>10.2f}{:>10.2f}{:>12.3f}{:>22}\n", name(who), g.first,
                       g.last, g.largest, g.slope.value,
                       fmt::format("{:.3f} to {:.3f}", g.slope.low, g.slope.high));
  }
  out +=
      fmt::format("worst: {}, {:.3f} MiB an hour over {:.1f} min, {} clients; at most {:g}: {}\n",
                  name(*worst), of(*worst).slope.value, outcome.minutes, outcome.clients,
                  kMostGrowth, grows(outcome) ? "GROWS" : "ok");
  for (const std::string& what : outcome.violations) out += "VIOLATED: " + what + "\n";
  return out;
}

}  // namespace handrail::storm
