// handrail-rig: a simulated controller, arm and force sensor that speak the real wire protocols.
#include <cstdio>
#include <string>

#include <spdlog/spdlog.h>

#include "devices/rig/rig_options_io.h"
#include "devices/rig/rig_server.h"
#include "proto/config.pb.h"
#include "server/base/output.h"
#include "server/base/realtime.h"
#include "server/daemon/daemon_args.h"
#include "server/daemon/daemon_log.h"
#include "server/scene/config_io.h"

namespace {

constexpr int kBadInput = 2;

const char kWhat[] =
    "A simulated laboratory: an RV-2A behind a CR1-571 that speaks real-time external control, and "
    "a\n"
    "force/torque sensor that streams RDT. An alarm silences the controller; SIGUSR1 resets it.\n"
    "SIGUSR2 pulls the network cables of both, and plugs them in again.";

int fail(const std::string& message) {
  std::fprintf(stderr, "handrail-rig: %s\n", message.c_str());
  return kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  const auto args = handrail::parse_daemon_args(argc, argv);
  if (const auto code = handrail::answer_at_once(args, "handrail-rig", kWhat)) return *code;
  const auto config = handrail::load_rig_config(args->config_path);
  if (!config) return fail(config.message());
  const auto options = handrail::rig_options(*config);
  if (!options) {
    return fail((args->config_path.empty() ? "" : args->config_path + ": ") + options.message());
  }
  if (args->check) {
    std::puts("configuration ok");
    return handrail::end_output("handrail-rig", 0);
  }
  // Standard output carries only the READY line.
  const handrail::DaemonLog log("handrail-rig");
  handrail::RigServer server(*options);
  const auto port = [](std::uint32_t value) { return static_cast<std::uint16_t>(value); };
  const handrail::Status opened =
      server.open(config->address(), port(config->robot_port()), port(config->sensor_port()));
  if (!opened) return fail(opened.message());
  if (config->has_tap()) {
    if (const handrail::Status tap = server.open_tap(config->tap()); !tap)
      return fail(tap.message());
  }
  server.handle_signals();
  std::printf("READY robot_port=%d sensor_port=%d\n", server.robot_port(), server.sensor_port());
  std::fflush(stdout);
  // A controller keeps its cycle whatever else runs.
  const handrail::RealtimeGrant realtime = handrail::enter_realtime(75);
  spdlog::info("control thread: {}", realtime.report);
  const std::string advice = handrail::realtime_advice({realtime});
  if (!advice.empty()) spdlog::warn("{}", advice);
  server.run();
  return 0;
}
