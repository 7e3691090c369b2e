// What runs in the namespaces of each side: rig and slave, master and operator.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "client/api/operator_client.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/status.h"
#include "tests/links/cell.h"
#include "tests/links/outcome.h"
#include "tests/support/child.h"

namespace handrail::links {
namespace {

constexpr Nanos kStart = 20 * kSecond;  // for a program to start or end on a busy machine
constexpr Nanos kLook = 20 * kMillisecond;
constexpr Nanos kOperatorDelay = 300 * kMillisecond;  // as in the lab
constexpr const char* kSlaveReady = "/slave-ready";
constexpr const char* kDone = "/near.done";

bool wait_for(Child& child, const std::string& part, std::string& rest) {
  const Nanos give_up = monotonic_now() + kStart;
  while (!child.printed(part, rest)) {
    if (!child.running() || monotonic_now() > give_up) {
      std::fprintf(stderr, "'%s' does not start: %s\n", child.path().c_str(),
                   child.output().c_str());
      return false;
    }
    sleep_until(monotonic_now() + 2 * kMillisecond);
  }
  return true;
}
bool wait_for_file(const std::string& path, Nanos patience) {
  const Nanos give_up = monotonic_now() + patience;
  while (!std::filesystem::exists(path)) {
    if (monotonic_now() > give_up) return false;
    sleep_until(monotonic_now() + kMillisecond);
  }
  return true;
}
void end(Child& child) {
  child.send(SIGTERM);
  const Nanos give_up = monotonic_now() + kStart;
  while (child.running() && monotonic_now() < give_up) sleep_until(monotonic_now() + kLook);
}
std::string write_config(const std::string& folder, const std::string& name,
                         const std::string& text) {
  std::string path = folder + "/" + name + ".cfg";
  std::ofstream(path) << text;
  return path;
}
int number_after(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  return at == std::string::npos ? 0 : std::atoi(text.c_str() + at + part.size());
}

class Operator {
 public:
  explicit Operator(const std::string& socket) : client_(socket) {}

  // Until both sides are engaged: when; 0: not by `give_up`.
  Nanos engage(Nanos give_up) {
    while (monotonic_now() < give_up) {
      pb::Request request;
      request.set_engage(true);
      const auto reply = client_.call(request, give_up - monotonic_now());
      if (reply && reply->done()) {
        while (!led() && monotonic_now() < give_up) sleep_until(monotonic_now() + kMillisecond);
        return led() ? monotonic_now() : 0;
      }
      sleep_until(monotonic_now() + kLook);
    }
    return 0;
  }
  // Engaged, and in its way again whenever it is over.
  void drive(Nanos until, NearOutcome& out) {
    double squares = 0.0;
    int looks = 0;
    while (monotonic_now() < until) {
      sleep_until(monotonic_now() + kLook);
      const pb::Status now = status();
      if (now.state() == "off" || now.state() == "fault") {
        ++out.ends;
        sleep_until(monotonic_now() + kOperatorDelay);
        pb::Request reset;
        reset.set_reset(true);
        (void)client_.call(reset, kSecond);
        (void)engage(until);
        continue;
      }
      const double behind = now.ledger().behind_mm();
      squares += behind * behind;
      ++looks;
    }
    out.behind = looks == 0 ? 0.0 : std::sqrt(squares / looks);
  }

 private:
  pb::Status status() {
    pb::Request request;
    request.set_status(true);
    const auto reply = client_.call(request, kSecond);
    return reply ? reply->status() : pb::Status();
  }
  bool led() {
    const pb::Status now = status();
    return now.state() == "engaged" && now.slave_state() == "engaged";
  }
  OperatorClient client_;
};

}  // namespace

int run_near(const RunPlan& plan, const std::string& folder) {
  ::setenv("HANDRAIL_KEYS", (folder + "/master-keys").c_str(), 1);
  const std::string socket = "/tmp/links/operator.sock";
  const std::string config =
      write_config(folder, "master",
                   fmt::format("operator_socket: '{}' scene: 'links' scene_path: '{}' "
                               "device {{ kind: RECORDED recording: '{}/hand.csv' }}\n",
                               socket, folder, folder));
  if (!wait_for_file(folder + kSlaveReady, kStart)) return 1;
  NearOutcome out;
  out.launched = monotonic_now();
  Child master("handrail-master", {"--config", config, "--link", "10.77.0.2"},
               folder + "/master.out");
  std::string rest;
  if (!wait_for(master, "READY", rest)) return 1;
  out.started = monotonic_now();
  Operator hand(socket);
  out.engaged_at = hand.engage(out.launched + static_cast<Nanos>(1e9 * plan.engage_s));
  if (out.engaged_at > 0) {
    const Nanos from = plan.motion == Motion::kSines ? out.engaged_at : out.started;
    hand.drive(from + static_cast<Nanos>(1e9 * plan.drive_s), out);
  }
  out.ended = monotonic_now();
  std::ofstream(folder + "/near.outcome") << outcome_text(out);
  std::ofstream(folder + kDone) << "\n";
  end(master);
  return 0;
}

int run_far(const std::string& folder) {
  ::setenv("HANDRAIL_KEYS", (folder + "/slave-keys").c_str(), 1);
  Child rig("handrail-rig",
            {"--config", write_config(folder, "rig",
                                      fmt::format("robot_port: 0 sensor_port: 0 "
                                                  "repeatability_mm: 0 tap: '{}/rig.tap'\n",
                                                  folder))},
            folder + "/rig.out");
  std::string rest;
  if (!wait_for(rig, "READY", rest)) return 1;
  const std::string config = write_config(
      folder, "slave",
      fmt::format("robot {{ port: {} }} force_sensor {{ port: {} }} scene: 'links' "
                  "scene_path: '{}'\n",
                  number_after(rest, "robot_port="), number_after(rest, "sensor_port="), folder));
  Child slave("handrail-slave", {"--config", config, "--link", "any"}, folder + "/slave.out");
  if (!wait_for(slave, "READY", rest)) return 1;
  std::ofstream(folder + kSlaveReady) << "\n";
  const bool done = wait_for_file(folder + kDone, 1000 * kSecond);
  end(slave);
  end(rig);
  return done ? 0 : 1;
}

}  // namespace handrail::links
