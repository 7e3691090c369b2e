#include "tests/emulator/emulator.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "server/base/clock.h"
#include "server/base/realtime.h"

namespace handrail::emulator {
namespace {

constexpr int kPriority = 75;  // the rig's: it stands for what is no program of this computer
constexpr Nanos kInjectEvery = kMillisecond;
constexpr int kMostAtOnce = 64;  // packets read before the other side has its turn
constexpr std::array<Side, 2> kSides = {Side::kNear, Side::kFar};

}  // namespace

Nanos Emulator::now() const { return monotonic_now(); }

Tap* Emulator::tap(Side side) {
  return taps_.empty() ? nullptr : &taps_[side == Side::kNear ? 0 : 1];
}

Status Emulator::start(const EmulatorOptions& options) {
  options_ = options;
  for (const Side which : kSides) {
    Status made = side(which).start({which, options.mtu, options.shared});
    if (!made) return made;
  }
  in_.resize(kLongestPacket);
  out_.resize(kLongestPacket);
  network_.emplace(options.seed);
  // Not before: the programs would have it from us.
  timing_ = enter_realtime(kPriority).report;
  started_ = now();
  network_->begin(options.plan, started_);
  return Status::ok();
}

void Emulator::flush_taps() {
  for (Tap& log : taps_) log.flush();
}

Status Emulator::record(const std::string& folder, std::size_t most) {
  for (const Side which : kSides) {
    auto opened = Tap::open(folder + "/" + name_of(which) + ".pcap", most);
    if (!opened) return opened.status();
    taps_.push_back(std::move(*opened));
  }
  return Status::ok();
}

Status Emulator::run(Side which, const std::string& name, const std::vector<std::string>& words) {
  if (options_.output.empty()) return side(which).run(name, words);
  const std::string path = options_.output + "/" + name_of(which) + "-" + name + ".out";
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0) {
    return Status::error(path + ": cannot write: " + std::generic_category().message(errno));
  }
  Status started = side(which).run(name, words, file);
  ::close(file);
  return started;
}

void Emulator::deliver(Nanos now) {
  while (const auto arrived = network_->take(now, out_)) {
    const std::span<const std::uint8_t> packet = std::span(out_).first(arrived->size);
    if (::write(side(arrived->at).wire(), packet.data(), packet.size()) < 0) ++refused_;
    const Nanos at = monotonic_now();
    if (arrived->origin != Origin::kInjected) late_.add(at - arrived->due);
    if (Tap* const log = tap(arrived->at)) {
      log->delivered(packet, arrived->number, arrived->origin, at);
    }
  }
}

void Emulator::read_wire(Side from) {
  for (int i = 0; i < kMostAtOnce; ++i) {
    const ssize_t size = ::read(side(from).wire(), in_.data(), in_.size());
    if (size <= 0) return;
    const Nanos at = monotonic_now();
    deliver(at);
    const std::span<const std::uint8_t> packet =
        std::span(in_).first(static_cast<std::size_t>(size));
    const std::uint64_t ignored = network_->counts(other(from)).ignored;
    const std::uint64_t number = network_->send(from, packet, at);
    Tap* const log = tap(from);
    if (log != nullptr && network_->counts(other(from)).ignored == ignored) {
      log->sent(packet, number, at);
    }
    deliver(at);
  }
}

void Emulator::inject_due(Nanos now) {
  for (Running& running : injections_) {
    Injection& what = running.what;
    const auto due = static_cast<std::uint64_t>(to_seconds(now - running.since) * what.per_second);
    // A burst at most; one that fell behind catches up over several.
    const auto burst = static_cast<std::uint64_t>(2.0 * what.per_second * to_seconds(kInjectEvery));
    const std::uint64_t late = due + 1 > running.done ? due + 1 - running.done : 0;
    for (std::uint64_t i = std::min({late, burst + 1, what.left}); i > 0; --i) {
      network_->inject(what.to, what.next(), now);
      ++running.done;
      --what.left;
    }
  }
  std::erase_if(injections_, [](const Running& running) { return running.what.left == 0; });
}

Nanos Emulator::next_event(Nanos until) const {
  Nanos out = std::min(until, network_->next_due());
  if (!injections_.empty()) out = std::min(out, now() + kInjectEvery);
  return out;
}

bool Emulator::turn(std::span<pollfd> others, Nanos until) {
  std::vector<pollfd> wait(others.begin(), others.end());
  for (const Side which : kSides) {
    wait.push_back({side(which).wire(), POLLIN, 0});
    wait.push_back({side(which).news(), POLLIN, 0});
  }
  for (;;) {
    inject_due(now());
    deliver(now());
    const Nanos left = std::max<Nanos>(next_event(until) - now(), 0);
    const timespec time{left / kSecond, left % kSecond};
    const int ready = ::ppoll(wait.data(), wait.size(), &time, nullptr);
    if (ready < 0 && errno != EINTR) return false;
    if (ready > 0) {
      bool news = false;
      for (std::size_t i = 0; i < kSides.size(); ++i) {
        const pollfd* const of = wait.data() + others.size() + 2 * i;
        if (of[0].revents != 0) read_wire(kSides[i]);
        if (of[1].revents == 0) continue;
        if (!side(kSides[i]).take_news()) return false;
        news = true;
      }
      for (std::size_t i = 0; i < others.size(); ++i) {
        others[i].revents = wait[i].revents;
        news = news || wait[i].revents != 0;
      }
      if (news) return true;
    }
    if (now() >= until) return true;
  }
}

Report Emulator::report() const {
  Report out;
  out.seed = options_.seed;
  out.seconds = to_seconds(now() - started_);
  out.to_far = network_->counts(Side::kFar);
  out.to_near = network_->counts(Side::kNear);
  out.missed_near = sides_[0].missed();
  out.missed_far = sides_[1].missed();
  out.refused = refused_;
  out.timing = timing_;
  out.late_p50 = late_.quantile(0.5);
  out.late_p999 = late_.quantile(0.999);
  out.late_worst = late_.max();
  for (const Side which : kSides) {
    for (const auto& [name, program] : sides_[which == Side::kNear ? 0 : 1].programs()) {
      out.programs.push_back({name_of(which), name, program.pid, program.ending()});
    }
  }
  return out;
}

Status Emulator::close() {
  Status out = Status::ok();
  for (Tap& log : taps_) {
    if (Status closed = log.close(); !closed) out = closed;
  }
  taps_.clear();
  return out;
}

}  // namespace handrail::emulator
