// handrail-rig: a simulated controller, arm and force sensor that speak the real wire protocols.
#include <cstdio>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "devices/rig/rig_options_io.h"
#include "devices/rig/rig_server.h"
#include "devices/rig/rig_status_server.h"
#include "proto/config.pb.h"
#include "server/base/output.h"
#include "server/base/realtime.h"
#include "server/daemon/daemon_args.h"
#include "server/daemon/daemon_log.h"
#include "server/daemon/run_daemon.h"
#include "server/scene/config_io.h"

namespace {

constexpr int kPriority = 75;  // between the daemons' control and IO threads

const char kWhat[] =
    "A simulated laboratory: an RV-2A behind a CR1-571 that speaks real-time external control, and "
    "a\n"
    "force/torque sensor that streams RDT. An alarm silences the controller; SIGUSR1 resets it.\n"
    "SIGUSR2 pulls the network cables of both, and plugs them in again.";

int fail(const std::string& message) { return handrail::fail_start("handrail-rig", message); }

// The controller's own switches where the file says; else, if they can be had, after its port.
handrail::Status open_switches(handrail::RigServer& server, const handrail::pb::RigConfig& config) {
  using handrail::Status;
  if (config.has_command_port()) {
    return server.open_switches(config.address(),
                                static_cast<std::uint16_t>(config.command_port()));
  }
  const std::uint32_t robot = config.robot_port();
  const auto next = static_cast<std::uint16_t>(robot == 0 ? 0 : robot % 65535 + 1);
  if (const Status s = server.open_switches(config.address(), next); !s) {
    spdlog::warn("{}; goes on without the controller's own switches", s.message());
  }
  return Status::ok();
}

int run(int argc, char** argv) {
  using namespace handrail;
  const auto args = parse_daemon_args(argc, argv);
  if (const auto code = answer_at_once(args, "handrail-rig", kWhat)) return *code;
  const auto config = load_rig_config(args->config_path);
  if (!config) return fail(config.message());
  const auto options = rig_options(*config);
  if (!options) {
    return fail((args->config_path.empty() ? "" : args->config_path + ": ") + options.message());
  }
  if (args->check) {
    std::puts("configuration ok");
    return end_output("handrail-rig", 0);
  }
  // Standard output carries only the READY line.
  const DaemonLog log("handrail-rig", kPriority);
  Announcement ready;
  RigServer server(*options);
  const auto port = [](std::uint32_t value) { return static_cast<std::uint16_t>(value); };
  const Status opened =
      server.open(config->address(), port(config->robot_port()), port(config->sensor_port()));
  if (!opened) return fail(opened.message());
  if (const Status opened_too = open_switches(server, *config); !opened_too) {
    return fail(opened_too.message());
  }
  if (config->has_tap()) {
    if (const Status tap = server.open_tap(config->tap()); !tap) return fail(tap.message());
  }
  RigFeed feed(options->world.has_value());
  RigStatusServer status(
      feed, options->world ? config->scene() : "",
      workpiece_finder({config->scene_path().begin(), config->scene_path().end()}));
  std::string place;
  if (config->has_status_socket()) {
    if (const Status told = status.start(config->status_socket()); !told)
      return fail(told.message());
    server.tell(feed);
    place = " status=" + config->status_socket();
  }
  server.handle_signals();
  ready.make(fmt::format("READY robot_port={} sensor_port={} command_port={}{}",
                         server.robot_port(), server.sensor_port(), server.command_port(), place));
  // A controller keeps its cycle whatever else runs.
  const RealtimeGrant realtime = enter_realtime(kPriority);
  spdlog::info("control thread: {}", realtime.report);
  const std::string advice = realtime_advice({realtime});
  if (!advice.empty()) spdlog::warn("{}", advice);
  server.run();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return handrail::run_daemon("handrail-rig", [&] { return run(argc, argv); });
}
