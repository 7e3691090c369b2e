// handrail-master: the operator's side, with the haptic device and the constraint engine.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "devices/config/device_config_io.h"
#include "devices/config/handle_sensor.h"
#include "devices/registry.h"
#include "proto/config.pb.h"
#include "server/base/clock.h"
#include "server/base/output.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"
#include "server/base/units.h"
#include "server/daemon/daemon_main.h"
#include "server/daemon/descriptors.h"
#include "server/daemon/errand.h"
#include "server/link/secure/secure_transport.h"
#include "server/link/unix_transport.h"
#include "server/master/governing.h"
#include "server/master/haptic_loop.h"
#include "server/master/haptic_settings.h"
#include "server/master/master_server.h"
#include "server/master/wall_runs.h"
#include "server/packets/packet_tap.h"
#include "server/record/device_io.h"
#include "server/record/record_setup.h"
#include "server/record/scene_records.h"
#include "server/scene/config_io.h"
#include "server/scene/scene_library.h"

#ifdef HANDRAIL_DELETABLE
#error "a build whose checks can be left out is for handrail-lab only"
#endif

namespace handrail {
namespace {

constexpr int kHapticPriority = 85;
// The thread has its grants by then: locking memory takes some 15 ms.
constexpr Nanos kSetUp = 50 * kMillisecond;

const char kWhat[] =
    "The operator's side: haptic device, virtual tools and forces at 1 kHz; sends the command to\n"
    "the slave and takes orders on a Unix socket, and where asked to over TLS. SIGTERM\n"
    "disengages, then exits.";

int fail(const std::string& message) { return fail_start("handrail-master", message); }

void log_line(bool bad, const std::string& line) {
  spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
}

// The thread that ticks the loop until it has finished; then the device is closed.
class HapticThread {
 public:
  HapticThread(HapticDevice& device, const LoopScene& scene, MasterMailboxes& boxes, MasterTap* tap,
               const HandleSetup& handle)
      : loop_(std::make_unique<HapticLoop>(device, scene, boxes, monotonic_now() + kSetUp, tap,
                                           handle)) {
    const SignalsBlocked blocked;
    thread_ = std::thread([this, &device] { run(device); });
  }
  ~HapticThread() {
    loop_->request_stop();
    thread_.join();
  }
  HapticThread(const HapticThread&) = delete;
  HapticThread& operator=(const HapticThread&) = delete;

  // What the thread got of what it asked for, once the loop has its first state to show. Once.
  RealtimeGrant realtime() { return realtime_.get_future().get(); }
  void request_stop() noexcept { loop_->request_stop(); }
  bool finished() const noexcept { return loop_->finished(); }

 private:
  void run(HapticDevice& device) {
    const RealtimeGrant got = enter_realtime(kHapticPriority);
    bool told = false;
    while (!loop_->finished()) {
      const Nanos turn = device.wait(loop_->due());
      loop_->tick(monotonic_now(), turn);
      if (!std::exchange(told, true)) realtime_.set_value(got);
    }
    device.close();
  }

  std::unique_ptr<HapticLoop> loop_;
  std::promise<RealtimeGrant> realtime_;
  std::thread thread_;  // last: it uses the others
};

OrderDeskOptions desk_of(const pb::MasterConfig& config, const HapticCapabilities& capabilities) {
  OrderDeskOptions out;
  out.identity.device = capabilities.name;
  out.identity.device_simulated = capabilities.simulated;
  out.identity.workspace_half = capabilities.workspace_half;
  out.identity.max_force = capabilities.max_force;
  out.identity.device_turns = capabilities.senses_rotation;
  out.identity.led_by_cursor = capabilities.led_by_cursor;
  out.identity.loop_warn = LadderSettings().warn_loop;
  out.identity.loop_limit = nanos_of_ms(config.loop_limit_ms());
  out.presence = presence_of(config, capabilities);
  out.user = own_user_name();
  out.identity.slave_at = config.has_slave() ? config.slave() : config.link_socket();
  return out;
}

// The link that is asked for; the error says why it cannot be had.
Result<TransportMaker> link_of(const pb::MasterConfig& config) {
  if (config.has_slave()) {
    const std::uint32_t usual = pb::SlaveConfig::default_instance().link_port();
    const auto slave = parse_host(config.slave(), static_cast<std::uint16_t>(usual));
    if (!slave) return Status::error("slave " + slave.message());
    const auto options = secure_options(KeyFolder(default_key_folder()));
    if (!options) {
      return Status::error("slave " + config.slave() + ": " + options.message() +
                           "; leave it out for the plain link with a slave on this computer");
    }
    return calling_link(*options, *slave);
  }
  return TransportMaker([path = config.link_socket()](boost::asio::io_context& io) {
    return std::make_unique<UnixTransport>(io, UnixTransport::End::kMaster, path);
  });
}

// Operators on other computers, if they are to be served. The error says why they cannot be.
Result<std::optional<RemoteOperatorOptions>> remote_operators_of(const pb::MasterConfig& config) {
  if (!config.has_operator_address()) return std::optional<RemoteOperatorOptions>();
  const auto keys = secure_options(KeyFolder(default_key_folder()), "the operators' port");
  if (!keys) {
    return Status::error("operator_address " + config.operator_address() + ": " + keys.message() +
                         "; leave it out for operators on this computer only");
  }
  return std::optional(RemoteOperatorOptions{*keys, config.operator_address(),
                                             static_cast<std::uint16_t>(config.operator_port())});
}

std::unique_ptr<Recorder> make_recorder(const pb::MasterConfig& config,
                                        const HapticCapabilities& device, MasterTap& tap,
                                        PacketTap& packets) {
  pb::RecordedStart start = recorded_start("handrail-master", random_session_id(), config);
  put(device, *start.mutable_device());
  return std::make_unique<Recorder>(recorder_options(config.recording(), log_line),
                                    make_feed(tap, {&packets}), std::move(start));
}

int run(const pb::MasterConfig& config, bool check_only, const DaemonLog& log) {
  auto device = make_haptic_device(haptic_options(config.device()));
  if (!device) return fail(device.message());
  const HapticCapabilities capabilities = (*device)->capabilities();
  const std::vector<std::string> folders(config.scene_path().begin(), config.scene_path().end());
  const auto library = std::make_shared<const SceneLibrary>(folders);
  const auto records = std::make_shared<SceneRecords>(config.has_recording());
  auto scene = records->load(*library, config.scene());
  if (!scene) return fail(scene.message());
  WallRuns wall_runs;
  const auto tap = config.has_recording() ? std::make_unique<MasterTap>() : nullptr;
  const auto packets = tap ? std::make_unique<PacketTap>() : nullptr;
  std::unique_ptr<Recorder> recorder;  // ends before what it reads
  std::uint32_t scenes_so_far = 0;
  const auto loop_scene = [&](const Scene& s) {
    LoopScene out = loop_scene_of(s, capabilities, config, wall_runs);
    out.number = ++scenes_so_far;
    if (recorder) recorder->scene(records->take(s.name, out.number));
    for (const std::string& text : warnings_of(s)) spdlog::warn("{}", text);
    const auto checked = check_renderings(s, capabilities);
    for (const std::string& text : stability_warnings(checked, capabilities, config.governor())) {
      spdlog::warn("{}", text);
    }
    return out;
  };
  const HandleSensor handle = make_handle_sensor(config, log_line);
  if (handle.real.net && packets) handle.real.net->keep(packets.get());
  const Result<TransportMaker> link = link_of(config);
  if (!link) return fail(link.message());
  const auto remote = remote_operators_of(config);
  if (!remote) return fail(remote.message());
  if (check_only) {
    std::puts("configuration ok");
    const auto checked = check_renderings(*scene, capabilities);
    for (const std::string& text : stability_lines(checked, capabilities, config.governor())) {
      std::puts(text.c_str());
    }
    return end_output("handrail-master", 0);
  }

  if (tap) recorder = make_recorder(config, capabilities, *tap, *packets);
  const RecorderEnd recorder_end(recorder.get());
  const LoopScene first = loop_scene(*scene);
  DaemonNews news;
  Errand<Result<Scene>> scenes;
  raise_descriptor_limit(2 * OperatorServer::kMaxClients);
  auto boxes = std::make_unique<MasterMailboxes>();
  OrderDeskOptions desk_options = desk_of(config, capabilities);
  desk_options.identity.log_lost = [&log] { return log.lost(); };
  desk_options.identity.handle_sensor = handle.name();
  desk_options.identity.handle_simulated = handle.simulated != nullptr;
  desk_options.load_scene = [&scenes, library, records](const std::string& name) {
    return scenes.poll([library, records, name] { return records->load(*library, name); });
  };
  desk_options.loop_scene = loop_scene;
  desk_options.recorder = recorder.get();
  if (recorder) desk_options.record_folder = recorder->folder();
  OrderDesk desk(*boxes, *scene, desk_options);
  const auto server = make_master_server(*boxes, desk,
                                         {*link,
                                          config.operator_socket(),
                                          desk_options.identity.slave_at,
                                          *remote,
                                          config.busy_poll(),
                                          recorder.get(),
                                          packets.get(),
                                          handle.any(),
                                          {handle.q_HF, !handle.simulated}});
  hold_endings();
  if (const Status opened = server->open(); !opened) return fail(opened.message());
  if (const Status opened = (*device)->open(); !opened) return fail(opened.message());
  handle.start(log_line);

  HapticThread haptic(**device, first, *boxes, tap.get(), {handle.lever_M, handle.simulated.get()});
  const RealtimeGrant realtime = haptic.realtime();
  desk.set_realtime(realtime.report);
  news.serve(
      *server,
      fmt::format("READY link={} operator_socket={}", server->place(), config.operator_socket()),
      {"haptic", realtime, [&] { haptic.request_stop(); }, [&] { return haptic.finished(); }});
  handle.stop();
  return 0;
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  using namespace handrail;
  const DaemonOption options[] = {
      {"--link", "the slave, HOST or HOST:PORT, over the encrypted link", &DaemonArgs::link},
      {"--operators", "listen for operators on other computers: any, or an address",
       &DaemonArgs::operators}};
  return daemon_main(
      argc, argv, "handrail-master", kWhat, options,
      [](const DaemonArgs& args) {
        return load_master_config(args.config_path, args.link, args.operators);
      },
      run);
}
