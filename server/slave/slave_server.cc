#include "server/slave/slave_server.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/link/link_server.h"
#include "server/link/session_watch.h"
#include "server/session/session.h"
#include "server/slave/connection_watch.h"

namespace handrail {

namespace {

// Between two looks for the master's scene, whatever it asks for: names that alternate must not
// keep the disk busy, nor fill the log. An operator can wait so long for a second scene.
constexpr Nanos kScenePause = kSecond;

}  // namespace

struct SlaveServer::Impl {
  Impl(SlaveMailboxes& mailboxes, FtSensor* ft_sensor, SlaveServerOptions opts)
      : boxes(mailboxes), sensor(ft_sensor), options(std::move(opts)) {}

  void tick(Nanos now) {
    poll_sensor(now);
    known = boxes.report.take(report) || known;
    if (!known) return;
    if (alive) alive(now, now <= report.good_until);
    say_halts(now);
    say_connection();
    take_scene(now);
    SlaveState told = report.state;
    const auto in_words = [](Reason reason) {
      std::string out = describe(reason);
      if (reason == Reason::kRobotLost) out.append("; ").append(ConnectionWatch::kResetTries);
      return out;
    };
    const Reason why = told.state == SessionState::kFault ? told.fault : told.reason;
    if (const auto line = session.step(now, told.state, why, in_words)) {
      say(told.state == SessionState::kFault, *line);
    }
    told.log_lost = options.log_lost && options.log_lost() > 0;
    if (scene_missing && told.state == SessionState::kOff) told.reason = Reason::kSceneNotLoaded;
    link.send(now, told, report.good_until, report.good_until);
  }

  // At most a line a second.
  void say_halts(Nanos now) {
    if (report.halts == said_halts || now < next_halt_line) return;
    spdlog::warn("the controller was not heard in time: the moving arm was halted, {} times so far",
                 report.halts);
    said_halts = report.halts;
    next_halt_line = now + kSecond;
  }

  void say_connection() {
    const auto line =
        connection.step(report.connected, report.lost, text_of(report.problem), report.state.fault);
    if (line) say(line->bad, line->text);
  }

  static void say(bool bad, const std::string& line) {
    spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
  }

  void hear(Nanos now) {
    boxes.master.publish({link.newest(), link.snapshot()});
    follow_scene(now);
  }

  // While nothing moves, loads our file of the master's scene whenever the two sides differ.
  void follow_scene(Nanos now) {
    const MasterState& master = link.newest();
    const std::string wanted(text_of(master.scene));
    const SlaveState& state = report.state;
    const bool idle = state.state == SessionState::kOff || state.state == SessionState::kFault;
    if (!differs(master) || first_difference(master, tried) != Reason::kNone) scene_missing = false;
    if (reading) return;
    if (wanted.empty() || !idle || !known || !differs(master) || now < next_look) return;
    tried = master;
    reading = wanted;
    take_scene(now);
  }

  // What the disk has given of the scene that was looked for. The robot loop takes it over when it
  // may.
  void take_scene(Nanos now) {
    if (!reading) return;
    const auto loaded = options.load_scene(*reading);
    if (!loaded) return;
    next_look = now + kScenePause;  // the robot loop says by then that it has it
    const std::string name = *std::exchange(reading, std::nullopt);
    // The master has gone on to another.
    if (first_difference(link.newest(), tried) != Reason::kNone) return;
    scene_missing = !*loaded;
    if (!*loaded) {
      if (loaded->message() != scene_problem) {
        spdlog::error("the master's scene '{}' cannot be loaded: {}", name, loaded->message());
      }
      scene_problem = loaded->message();
      return;
    }
    scene_problem.clear();
    if (name != text_of(report.state.scene)) spdlog::info("scene '{}', as the master has it", name);
    boxes.settings.publish(**loaded);
  }

  bool differs(const MasterState& master) const {
    return first_difference(master, report.state) != Reason::kNone;
  }

  void poll_sensor(Nanos now) {
    FtSample sample;
    if (sensor == nullptr || !sensor->poll(now, sample)) return;
    boxes.force.publish({sample.wrench, sample.status == 0, now});
  }

  SlaveMailboxes& boxes;
  FtSensor* sensor;
  SlaveServerOptions options;
  LinkServer<SlaveState, MasterState> link{"robot", "master", boxes.doorbell};
  SlaveReport report;
  bool known = false;  // the robot loop has spoken
  SessionWatch session;
  ConnectionWatch connection{options.robot};
  std::function<void(Nanos, bool)> alive;
  std::uint64_t said_halts = 0;
  Nanos next_halt_line = -kForever;
  Nanos next_look = 0;                 // for a scene
  MasterState tried;                   // whose scene was looked for last
  std::optional<std::string> reading;  // its name, until the disk has given it
  std::string scene_problem;           // last one logged
  bool scene_missing = false;          // the last one tried could not be loaded
};

SlaveServer::SlaveServer(SlaveMailboxes& boxes, FtSensor* sensor, SlaveServerOptions options)
    : impl_(std::make_unique<Impl>(boxes, sensor, std::move(options))) {}
SlaveServer::~SlaveServer() = default;

Status SlaveServer::open() {
  return impl_->link.open({impl_->options.address, impl_->options.port});
}

std::uint16_t SlaveServer::port() const { return impl_->link.port(); }

void SlaveServer::run(std::function<void()> on_signal, std::function<bool()> finished,
                      std::function<void(Nanos, bool)> alive) {
  Impl& impl = *impl_;
  impl.alive = std::move(alive);
  impl.link.run({[&impl](Nanos now) { impl.hear(now); }, [&impl](Nanos now) { impl.tick(now); },
                 std::move(on_signal), std::move(finished), &Impl::say});
}

}  // namespace handrail
