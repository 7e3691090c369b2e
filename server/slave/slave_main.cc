// handrail-slave: drives the robot arm as the master says, within the arm's limits.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "devices/config/device_config_io.h"
#include "proto/config.pb.h"
#include "server/base/output.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"
#include "server/daemon/daemon_main.h"
#include "server/daemon/errand.h"
#include "server/link/secure/secure_transport.h"
#include "server/link/unix_transport.h"
#include "server/packets/packet_tap.h"
#include "server/record/device_io.h"
#include "server/record/record_setup.h"
#include "server/record/scene_records.h"
#include "server/scene/config_io.h"
#include "server/scene/payload_io.h"
#include "server/scene/scene_library.h"
#include "server/slave/follow_settings.h"
#include "server/slave/robot_loop.h"
#include "server/slave/slave_server.h"

#ifdef HANDRAIL_DELETABLE
#error "a build whose checks can be left out is for handrail-lab only"
#endif

namespace handrail {
namespace {

constexpr int kRobotPriority = 80;
constexpr double kMostSensorLag = 0.1;  // that the bumper can reckon with [s]

const char kWhat[] =
    "The robot's side: follows the master's commands on the arm, within its limits, and reports\n"
    "joints and contact forces back. SIGTERM stops the arm on its path, then exits.";

const char kInReach[] = "the controller's emergency stop must be in reach";

int fail(const std::string& message) { return fail_start("handrail-slave", message); }

std::string stop_text(const std::optional<StopSwitchOptions>& options) {
  if (!options) return fmt::format("stop circuit: none (stop_switch); {}", kInReach);
  const std::string key = options->key ? fmt::format("key {}", *options->key) : "any key";
  return fmt::format("stop circuit: {} of {}, no safety device; {}", key, options->path, kInReach);
}

// What is done to the force before the bumper feels it; empty: nothing.
std::string sensor_text(const FollowSettings& settings) {
  std::string out;
  if (!settings.payload.is_none()) {
    out =
        fmt::format("force sensor: {:.4g} kg are taken out of its readings", settings.payload.mass);
  }
  if (settings.force_lag > 0.0) {
    out += fmt::format(
        "{}its low pass makes the force {:.4g} ms late, {:.4g} ms behind the joints in all",
        out.empty() ? "force sensor: " : "; ", 1e3 * settings.force_lag,
        1e3 * settings.bumper.sensor_lag);
  }
  return out;
}

// The thread that turns the loop until it has finished.
class RobotThread {
 public:
  RobotThread(Robot& robot, const FollowSettings& settings, SlaveMailboxes& boxes, SlaveTap* tap,
              StopCircuit* stop)
      : loop_(robot, settings, boxes, monotonic_now, tap, stop) {
    const SignalsBlocked blocked;
    thread_ = std::thread([this] { run(); });
  }
  ~RobotThread() { finish(); }
  RobotThread(const RobotThread&) = delete;
  RobotThread& operator=(const RobotThread&) = delete;

  // What the thread got of what it asked for. Once.
  RealtimeGrant realtime() { return realtime_.get_future().get(); }
  void request_stop() noexcept { loop_.request_stop(); }
  // Asks it to stop and waits until it has.
  void finish() {
    request_stop();
    if (thread_.joinable()) thread_.join();
  }
  bool finished() const noexcept { return loop_.finished(); }

 private:
  void run() {
    realtime_.set_value(enter_realtime(kRobotPriority));
    while (!loop_.finished()) {
      const Nanos next = loop_.turn();
      if (next > 0) sleep_until(next);
    }
  }

  RobotLoop loop_;
  std::promise<RealtimeGrant> realtime_;
  std::thread thread_;  // last: it uses the others
};

// What the threads leave for who writes it down.
struct SlaveTaps {
  SlaveTap cycles;
  PacketTap robot;   // of the loop's thread: the controller's packets
  PacketTap server;  // of the server's: the link's and the sensor's
};

// What is known of the arm besides the scene, for who replays.
std::shared_ptr<Recorder> make_recorder(const pb::SlaveConfig& config, Nanos period,
                                        bool has_sensor, SlaveTaps& taps) {
  pb::RecordedStart start = recorded_start("handrail-slave", random_session_id(), config);
  *start.mutable_arm() =
      recorded_arm(period, has_sensor, config.force_sensor().range_n(),
                   payload_from(config.payload()), config.force_sensor().filter_ms() * 1e-3);
  const auto say = [](bool bad, const std::string& line) {
    spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
  };
  return std::make_shared<Recorder>(recorder_options(config.recording(), say),
                                    make_feed(taps.cycles, {&taps.robot, &taps.server}),
                                    std::move(start));
}

// What a scene means for the robot loop, by its name. Owns all that it uses.
using SettingsOf = std::function<Result<FollowSettings>(const std::string& scene)>;

SettingsOf settings_of(const pb::SlaveConfig& config, Nanos period, bool has_sensor,
                       const std::weak_ptr<Recorder>& recorder) {
  const std::vector<std::string> folders(config.scene_path().begin(), config.scene_path().end());
  return [config, library = SceneLibrary(folders), period, has_sensor, recorder,
          records = std::make_shared<SceneRecords>(config.has_recording()),
          number = std::make_shared<std::uint32_t>(0)](
             const std::string& scene) -> Result<FollowSettings> {
    const auto loaded = records->load(library, scene);
    if (!loaded) return loaded.status();
    const pb::FtConfig& force = config.force_sensor();
    FollowSettings out = follow_settings(*loaded, period, has_sensor, force.range_n(),
                                         payload_from(config.payload()), force.filter_ms() * 1e-3);
    out.number = ++*number;
    if (const auto to = recorder.lock()) to->scene(records->take(loaded->name, out.number));
    if (out.bumper.sensor_lag <= kMostSensorLag + 1e-9) return out;
    return Status::error(
        fmt::format("force_sensor.filter_ms: {} ms and bumper.sensor_lag_ms of scene {} make "
                    "{:.4g} ms, expected at most {} ms",
                    force.filter_ms(), scene, 1e3 * out.bumper.sensor_lag, 1e3 * kMostSensorLag));
  };
}

void say_counters(const MelfaRobot& robot, const NetFtSensor* sensor) {
  const MxtCounters& packets = robot.counters();
  spdlog::info("controller: {} replies taken, {} rejected, {} late; {} packets sent",
               packets.replies, packets.rejected, packets.late, packets.sent);
  if (sensor == nullptr) return;
  const RdtCounters& records = sensor->counters();
  spdlog::info("force sensor: {} records taken, {} rejected, {} out of order", records.records,
               records.rejected, records.stale);
}

// The link that is asked for; the error says why it cannot be had.
Result<TransportMaker> link_of(const pb::SlaveConfig& config) {
  if (config.has_link_address() || config.has_link_port()) {
    const auto options = secure_options(KeyFolder(default_key_folder()));
    if (!options) {
      return Status::error("link_address, link_port: " + options.message() +
                           "; leave both out for the plain link with a master on this computer");
    }
    return listening_link(*options, config.has_link_address() ? config.link_address() : "any",
                          static_cast<std::uint16_t>(config.link_port()));
  }
  return TransportMaker([path = config.link_socket()](boost::asio::io_context& io) {
    return std::make_unique<UnixTransport>(io, UnixTransport::End::kSlave, path);
  });
}

int run(const pb::SlaveConfig& config, bool check_only, const DaemonLog& log) {
  const auto taps = config.has_recording() && !check_only ? std::make_unique<SlaveTaps>() : nullptr;
  MelfaRobot robot(robot_options(config.robot()));
  const auto [sensor, net_sensor] =
      make_sensor(config.force_sensor(), [](bool bad, const std::string& line) {
        spdlog::log(bad ? spdlog::level::warn : spdlog::level::info, line);
      });
  const Nanos period = robot.capabilities().period;
  const auto recorder = taps ? make_recorder(config, period, sensor != nullptr, *taps) : nullptr;
  if (taps) robot.keep(&taps->robot);
  if (taps && net_sensor) net_sensor->keep(&taps->server);
  const SettingsOf load = settings_of(config, period, sensor != nullptr, recorder);
  const auto settings = load(config.scene());
  if (!settings) return fail(settings.message());
  const Result<TransportMaker> link = link_of(config);
  if (!link) return fail(link.message());
  const std::string sensor_says = sensor_text(*settings);
  const std::optional<StopSwitchOptions> stop_options = switch_options(config);
  if (check_only) {
    std::puts("configuration ok");
    if (!sensor_says.empty()) std::puts(sensor_says.c_str());
    std::puts(stop_text(stop_options).c_str());
    return end_output("handrail-slave", 0);
  }

  const RecorderEnd recorder_end(recorder.get());
  if (!sensor_says.empty()) spdlog::info("{}", sensor_says);
  DaemonNews news;
  Errand<Result<FollowSettings>> scenes;
  Errand<Result<Obstacle>> switches;
  SlaveMailboxes boxes;
  SlaveServerOptions options;
  options.link = *link;
  options.robot = robot.capabilities().name;
  options.load_scene =
      [&scenes, shared = std::make_shared<const SettingsOf>(load)](const std::string& scene) {
        return scenes.poll([shared, scene] { return (*shared)(scene); });
      };
  options.why_silent = [&switches, robot_is = robot_options(config.robot())] {
    const auto came = switches.poll([robot_is] { return Result<Obstacle>(why_silent(robot_is)); });
    if (!came) return std::optional<Obstacle>();
    return std::optional(*came ? **came : obstacle_in(came->message()));
  };
  options.log_lost = [&log] { return log.lost(); };
  options.busy_poll = config.busy_poll();
  options.packets = taps ? &taps->server : nullptr;
  const auto server = make_slave_server(boxes, sensor.get(), options);
  hold_endings();
  if (const Status opened = server->open(); !opened) return fail(opened.message());
  if (sensor) {
    if (const Status started = sensor->start(); !started) return fail(started.message());
  }
  std::optional<StopSwitch> stop;
  if (stop_options) {
    if (const Status started = stop.emplace(*stop_options).start(); !started) {
      return fail("stop_switch: " + started.message());
    }
    spdlog::info("{}", stop_text(stop_options));
  }
  RobotThread loop(robot, *settings, boxes, taps ? &taps->cycles : nullptr,
                   stop ? &*stop : nullptr);
  news.serve(
      *server, fmt::format("READY link={}", server->place()),
      {"robot", loop.realtime(), [&] { loop.request_stop(); }, [&] { return loop.finished(); }});
  loop.finish();
  if (sensor) sensor->stop();
  say_counters(robot, net_sensor);
  return 0;
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  using namespace handrail;
  const DaemonOption options[] = {
      {"--link", "wait for the encrypted link at this address, or any", &DaemonArgs::link}};
  return daemon_main(
      argc, argv, "handrail-slave", kWhat, options,
      [](const DaemonArgs& args) { return load_slave_config(args.config_path, args.link); }, run);
}
