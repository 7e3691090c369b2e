#include "server/slave/slave_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "server/base/clock.h"
#include "server/base/version.h"
#include "server/link/granted.h"
#include "server/link/link_server.h"
#include "server/link/session_watch.h"
#include "server/session/hold_count.h"
#include "server/session/session.h"
#include "server/slave/connection_watch.h"

namespace handrail {
namespace {

// Between two looks for the master's scene, whatever it asks for: names that alternate must not
// keep the disk busy, nor fill the log. An operator can wait so long for a second scene.
constexpr Nanos kScenePause = kSecond;

class SlaveServer final : public IoServer {
 public:
  SlaveServer(SlaveMailboxes& mailboxes, FtSensor* ft_sensor, SlaveServerOptions opts)
      : boxes_(mailboxes), sensor_(ft_sensor), options_(std::move(opts)) {}

  Status open() override {
    link_.keep(options_.packets);
    if (options_.busy_poll) link_.poll_busily();
    return link_.open(options_.link);
  }
  std::string place() const override { return link_.place(); }

  void run(ServerHooks hooks) override {
    alive_ = std::move(hooks.alive);
    program_.realtime = granted(hooks.control, hooks.io);
    link_.run({[this](Nanos now) { hear(now); }, [this](Nanos now) { tick(now); },
               std::move(hooks.on_signal), std::move(hooks.finished), say});
    spdlog::info(
        "the arm stood for the link's sake {} times, for {:.3f} s in all, {:.3f} s at most",
        holds_.times(), to_seconds(holds_.held()), to_seconds(holds_.longest()));
  }

 private:
  void tick(Nanos now) {
    poll_sensor(now);
    known_ = boxes_.report.take(report_) || known_;
    if (!known_) return;
    holds_.step(now - std::exchange(last_tick_, now), report_.state.state, report_.state.reason);
    if (alive_) alive_(now, now <= report_.good_until);
    say_halts(now);
    say_connection(now);
    take_scene(now);
    SlaveState told = report_.state;
    const auto in_words = [](Reason reason) {
      std::string out = describe(reason);
      if (reason == Reason::kRobotLost) out.append("; ").append(ConnectionWatch::kResetTries);
      return out;
    };
    const Reason why = told.state == SessionState::kFault ? told.fault : told.reason;
    if (const auto line = session_.step(now, told.state, why, in_words)) {
      say(told.state == SessionState::kFault, *line);
    }
    told.log_lost = options_.log_lost && options_.log_lost() > 0;
    told.program = program_;
    told.program.calendar = std::max<Nanos>(calendar_now(), 0);
    say_silence(told);
    if (scene_missing_ && told.state == SessionState::kOff) told.reason = Reason::kSceneNotLoaded;
    link_.send(now, told, report_.good_until, report_.good_until);
  }

  // At most a line a second.
  void say_halts(Nanos now) {
    if (report_.halts == said_halts_ || now < next_halt_line_) return;
    spdlog::warn("the controller was not heard in time: the moving arm was halted, {} times so far",
                 report_.halts);
    said_halts_ = report_.halts;
    next_halt_line_ = now + kSecond;
  }

  void say_connection(Nanos now) {
    const std::string_view problem = text_of(report_.problem);
    const auto line =
        connection_.step(report_.connected, report_.lost, problem, report_.state.fault);
    if (line) say(line->bad, line->text);
    const bool silent = !report_.connected && (report_.lost || !problem.empty());
    if (const auto why = silence_.step(now, silent)) say(why->bad, why->text);
  }

  // In place of a reason that says no more than that there is no connection.
  void say_silence(SlaveState& told) const {
    if (silence_.reason() == Reason::kNone) return;
    for (Reason* reason : {&told.reason, &told.obstacle}) {
      const bool plain = *reason == Reason::kRobotNotConnected || *reason == Reason::kRobotLost;
      if (plain) *reason = silence_.reason();
    }
  }

  static void say(bool bad, const std::string& line) {
    spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
  }

  void hear(Nanos now) {
    boxes_.master.publish({link_.newest(), link_.snapshot()});
    follow_scene(now);
  }

  // While nothing moves, loads our file of the master's scene whenever the two sides differ.
  void follow_scene(Nanos now) {
    const MasterState& master = link_.newest();
    const std::string wanted(text_of(master.scene));
    const SlaveState& state = report_.state;
    const bool idle = state.state == SessionState::kOff || state.state == SessionState::kFault;
    if (!differs(master) || first_difference(master, tried_) != Reason::kNone) {
      scene_missing_ = false;
    }
    if (reading_) return;
    if (wanted.empty() || !idle || !known_ || !differs(master) || now < next_look_) return;
    tried_ = master;
    reading_ = wanted;
    take_scene(now);
  }

  // What the disk has given of the scene that was looked for. The robot loop takes it over when it
  // may.
  void take_scene(Nanos now) {
    if (!reading_) return;
    const auto loaded = options_.load_scene(*reading_);
    if (!loaded) return;
    next_look_ = now + kScenePause;  // the robot loop says by then that it has it
    const std::string name = *std::exchange(reading_, std::nullopt);
    // The master has gone on to another.
    if (first_difference(link_.newest(), tried_) != Reason::kNone) return;
    scene_missing_ = !*loaded;
    const Reason still = *loaded ? first_difference(link_.newest(), **loaded) : Reason::kNone;
    std::string problem;
    if (!*loaded) problem = "cannot be loaded: " + loaded->message();
    if (still != Reason::kNone) {
      problem = std::string("is another than the file of that name here: ") + describe(still);
    }
    if (!problem.empty() && problem != scene_problem_) {
      spdlog::error("the master's scene '{}' {}", name, problem);
    } else if (problem.empty() && name != text_of(report_.state.scene)) {
      spdlog::info("scene '{}', as the master has it", name);
    }
    scene_problem_ = problem;
    if (!*loaded) return;
    boxes_.settings.publish(**loaded);
  }

  bool differs(const MasterState& master) const {
    return first_difference(master, report_.state) != Reason::kNone;
  }

  void poll_sensor(Nanos now) {
    FtSample sample;
    if (sensor_ == nullptr || !sensor_->poll(now, sample)) return;
    boxes_.force.publish({sample.wrench, sample.status == 0, sample.overrange, now});
  }

  SlaveMailboxes& boxes_;
  FtSensor* sensor_;
  SlaveServerOptions options_;
  LinkServer<SlaveState, MasterState> link_{"robot", "master", boxes_.doorbell};
  SlaveReport report_;
  ProgramNews program_{0, version_code(program_version()), {}};
  bool known_ = false;  // the robot loop has spoken
  SessionWatch session_;
  HoldCount holds_;
  Nanos last_tick_ = 0;
  ConnectionWatch connection_{options_.robot};
  SilenceWatch silence_{options_.robot, options_.why_silent};
  std::function<void(Nanos, bool)> alive_;
  std::uint64_t said_halts_ = 0;
  Nanos next_halt_line_ = -kForever;
  Nanos next_look_ = 0;                 // for a scene
  MasterState tried_;                   // whose scene was looked for last
  std::optional<std::string> reading_;  // its name, until the disk has given it
  std::string scene_problem_;           // last one logged
  bool scene_missing_ = false;          // the last one tried could not be loaded
};

}  // namespace

std::unique_ptr<IoServer> make_slave_server(SlaveMailboxes& boxes, FtSensor* sensor,
                                            SlaveServerOptions options) {
  return std::make_unique<SlaveServer>(boxes, sensor, std::move(options));
}

}  // namespace handrail
