#include "tests/faults/bed.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/keys/key_folder.h"
#include "tests/emulator/report_text.h"

namespace handrail::faults {
namespace {

constexpr Nanos kStartPatience = 30 * kSecond;  // for a program to start or end on a busy machine
constexpr Nanos kOrderPatience = 20 * kSecond;  // an engage waits 10 s for a good link
constexpr Nanos kStatusPatience = 500 * kMillisecond;
constexpr Nanos kTick = 10 * kMillisecond;
constexpr Nanos kPoll = 5 * kMillisecond;

std::string text_of(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

bool left(const std::string& state) { return state == "off" || state == "fault"; }

}  // namespace

Bed::Bed(const BedOptions& options)
    : options_(options),
      random_(options.seed ^ 0xbedULL),
      client_(folder_.path() + "/operator/operator.sock", {}, options.interrupted),
      probe_(options.real_time) {}

// The emulator takes with it whatever runs on its sides.
Bed::~Bed() = default;

Status Bed::start() {
  folder_.write("storm.scene", storm::scene_text());
  if (Status made = make_keys(); !made) return made;
  if (options_.prepare) {
    if (Status made = options_.prepare(folder()); !made) return made;
  }
  std::vector<std::string> words = {"--seed",
                                    std::to_string(options_.seed % 1'000'000'000),
                                    "--json",
                                    "--tap",
                                    folder(),
                                    "--tap-bytes",
                                    std::to_string(options_.tap_bytes),
                                    "--share",
                                    folder(),
                                    "--share",
                                    HANDRAIL_BUILD_DIR,
                                    "--output",
                                    folder(),
                                    "--orders",
                                    folder() + "/orders",
                                    "--mtu",
                                    std::to_string(options_.mtu)};
  if (!options_.network.empty()) {
    words.insert(words.end(), {"--network", folder_.write("network", options_.network)});
  }
  netfault_ = std::make_unique<Child>("handrail-netfault", words, folder() + "/netfault.out", true);
  const Nanos give_up = monotonic_now() + kStartPatience;
  while (!line_.connect(folder() + "/orders")) {
    if (!netfault_->running() || monotonic_now() > give_up) {
      return Status::error(netfault_->output());
    }
    wait(kPoll);
  }
  start_ = monotonic_now();
  for (const Who who : {Who::kRig, Who::kSlave, Who::kMaster}) {
    if (Status started = start(who); !started) return started;
  }
  if (!connected(kStartPatience)) {
    return Status::error("master and slave do not hear each other: " + printed(Who::kMaster) +
                         printed(Who::kSlave));
  }
  return Status::ok();
}

Status Bed::make_keys() {
  keys_[static_cast<std::size_t>(Who::kSlave)] = folder() + "/slave-keys";
  keys_[static_cast<std::size_t>(Who::kMaster)] = folder() + "/master-keys";
  const KeyFolder cell(keys(Who::kSlave)), desk(keys(Who::kMaster));
  const auto own_cell = cell.create("cell", Role::kSlave);
  const auto own_desk = desk.create("desk", Role::kMaster);
  if (!own_cell) return own_cell.status();
  if (!own_desk) return own_desk.status();
  TrustList masters, slaves;
  for (Status made : {masters.add(own_desk->entry()), slaves.add(own_cell->entry()),
                      cell.save(masters, "a fault row"), desk.save(slaves, "a fault row")}) {
    if (!made) return made;
  }
  return Status::ok();
}

std::string Bed::keys(Who who) const { return keys_[static_cast<std::size_t>(who)]; }

std::string Bed::config(Who who) {
  std::string scene = fmt::format("scene: 'storm' scene_path: '{}'", folder());
  switch (who) {
    case Who::kRig:
      return fmt::format("repeatability_mm: 0 seed: {} tap: '{}'", options_.seed % 1'000'000,
                         tap());
    case Who::kSlave: return scene + ' ' + placed(options_.slave_config);
    default:
      return fmt::format("operator_socket: '{}/operator/operator.sock' {} {} {}", folder(), scene,
                         storm::kSteadyDevice, options_.master_config);
  }
}

std::string Bed::name_of(Who who) const {
  return fmt::format("{}{}", storm::name(who), starts_[static_cast<std::size_t>(who)]);
}

std::string Bed::placed(std::string text) const {
  constexpr std::string_view kFolder = "FOLDER";
  for (auto at = text.find(kFolder); at != std::string::npos; at = text.find(kFolder, at))
    text.replace(at, kFolder.size(), folder());
  return text;
}

Status Bed::start(Who who) {
  ++starts_[static_cast<std::size_t>(who)];
  const std::string file = folder_.write(name_of(who) + ".cfg", config(who));
  const std::string before = placed(who == Who::kMaster  ? options_.master
                                    : who == Who::kSlave ? options_.slave
                                                         : "");
  const std::string link = who == Who::kMaster  ? " --link 10.77.0.2"
                           : who == Who::kSlave ? " --link any"
                                                : "";
  if (who == Who::kMaster) {
    client_.close();
    story_.master_starts.push_back(monotonic_now());
  }
  if (who == Who::kSlave) slave_start_ = monotonic_now();
  const std::string program = std::string(HANDRAIL_BIN_DIR "/handrail-") + storm::name(who);
  Status ran = run(side_of(who), name_of(who),
                   fmt::format("HANDRAIL_KEYS={} exec {} {} --config {}{}", keys(who), before,
                               program, file, link));
  if (!ran) return ran;
  const Nanos give_up = monotonic_now() + kStartPatience;
  while (printed(who).find("READY") == std::string::npos) {
    if (over() || monotonic_now() > give_up) {
      return Status::error(name_of(who) + " does not start: " + printed(who));
    }
    wait(kPoll);
  }
  return Status::ok();
}

bool Bed::connected(Nanos patience) {
  const Nanos give_up = monotonic_now() + patience;
  while (!over() && monotonic_now() < give_up) {
    const auto now = status();
    if (now && now->has_tip() && !now->peer().name().empty() && now->packet_age_ms() >= 0.0 &&
        now->packet_age_ms() < 1000.0) {
      return true;
    }
    wait(kTick);
  }
  return false;
}

Result<std::string> Bed::emulator(const std::string& line) { return line_.order(line); }

bool Bed::need(const Result<std::string>& done) {
  if (!done) problem(done.message());
  return done.is_ok();
}

void Bed::signal(Who who, const std::string& name) {
  (void)need(emulator("signal " + side_of(who) + " " + name_of(who) + " " + name));
}

Status Bed::run(const std::string& side, const std::string& name, const std::string& line) {
  return emulator("run " + side + " " + name + " " + line).status();
}

std::string Bed::printed(const std::string& side, const std::string& name) const {
  return text_of(folder() + "/" + side + "-" + name + ".out");
}

std::string Bed::printed(Who who) const { return printed(side_of(who), name_of(who)); }

std::optional<pb::Status> Bed::status() {
  pb::Request request;
  request.set_status(true);
  const Result<pb::Reply> reply = client_.call(request, kStatusPatience);
  if (!reply || !reply->done()) return std::nullopt;
  return reply->status();
}

bool Bed::order(const std::string& text, std::string* said) {
  pb::Request request;
  if (!google::protobuf::TextFormat::ParseFromString(text, &request)) return false;
  const Result<pb::Reply> reply = client_.call(request, kOrderPatience);
  if (said != nullptr) *said = reply ? reply->reason() : reply.message();
  return reply && reply->done();
}

bool Bed::led() {
  const auto now = status();
  return now && now->state() == "engaged" && now->slave_state() == "engaged";
}

bool Bed::engage(Nanos patience) {
  const Nanos give_up = monotonic_now() + patience;
  while (!over() && monotonic_now() < give_up) {
    (void)order("reset: true");
    story_.engages.push_back({monotonic_now(), kForever});
    const bool done = order("engage: true", &engage_said_);
    const Nanos until = monotonic_now() + kSecond;
    bool is_led = false;
    while (done && !(is_led = led()) && monotonic_now() < until) wait(kTick);
    story_.engages.back().to = monotonic_now();
    if (is_led) return true;
    wait(100 * kMillisecond);
  }
  return false;
}

bool Bed::engage_by(const std::string& name, const std::string& line) {
  (void)order("reset: true");
  story_.engages.push_back({monotonic_now(), kForever});
  if (!run("near", name, line)) return false;
  const Nanos give_up = monotonic_now() + kOrderPatience;
  bool is_led = false;
  while (!over() && !(is_led = led()) && monotonic_now() < give_up) wait(kTick);
  story_.engages.back().to = monotonic_now();
  return is_led;
}

void Bed::drive(Nanos span, const std::function<void(const pb::Status&)>& look) {
  const Nanos until = monotonic_now() + span;
  while (!over() && monotonic_now() < until) {
    const auto now = status();
    if (now && look) look(*now);
    if (now && !left(now->state()) && !now->hand_moving()) {
      (void)order(storm::order_to(region_.any(random_), *now, 0.15 + 0.25 * random_.uniform()));
    }
    wait(std::min(kTick, std::max<Nanos>(until - monotonic_now(), 0)));
  }
}

void Bed::dash() {
  const auto now = status();
  if (!now) return;
  const double side = dash_to_far_ ? 0.9 : -0.9;
  dash_to_far_ = !dash_to_far_;
  (void)order(storm::order_to(region_.at(Vec3(side, side, 0.0), Vec3(0.0, 0.0, side)), *now, 0.25));
}

void Bed::wait(Nanos span) const {
  const Nanos until = monotonic_now() + span;
  while (!over() && monotonic_now() < until) {
    sleep_until(std::min(until, monotonic_now() + 50 * kMillisecond));
  }
}

}  // namespace handrail::faults
