#include "tests/storm/cell.h"

#include <spdlog/fmt/fmt.h>

#include <csignal>
#include <cstdlib>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/storm/drive.h"

namespace handrail::storm {
namespace {

constexpr Nanos kStartPatience = 20 * kSecond;  // for a program to start or end on a busy machine

int number_after(const std::string& output, const std::string& part) {
  const std::size_t at = output.find(part);
  return at == std::string::npos ? 0 : std::atoi(output.c_str() + at + part.size());
}

}  // namespace

Cell::Cell(const Sequence& sequence, bool as_shipped)
    : sequence_(sequence), as_shipped_(as_shipped) {
  folder_.write("storm.scene", scene_text());
}

Status Cell::start(Who who) {
  const std::string number = std::to_string(++starts_);
  const std::string file = folder_.write(name(who) + number + ".cfg", config(who));
  Program& p = program(who);
  const std::string output = folder_.path() + "/" + name(who) + number + ".out";
  p.child = std::make_unique<Child>("handrail-" + std::string(name(who)),
                                    std::vector<std::string>{"--config", file}, output, true,
                                    Streams{.error = logs_[static_cast<std::size_t>(who)]});
  p.paused = false;
  const Nanos give_up = monotonic_now() + kStartPatience;
  for (std::string rest; !p.child->printed("READY", rest);) {
    if (!p.child->running() || monotonic_now() > give_up) {
      return Status::error(std::string(name(who)) + " does not start: " + p.child->output());
    }
    sleep_until(monotonic_now() + 2 * kMillisecond);
  }
  if (who == Who::kRig) {
    const std::string said = p.child->output();
    robot_port_ = number_after(said, "robot_port=");
    sensor_port_ = number_after(said, "sensor_port=");
  }
  return Status::ok();
}

std::string Cell::config(Who who) {
  std::string scene = fmt::format("scene: 'storm' scene_path: '{}'", folder_.path());
  std::string hand = kSteadyDevice;
  if (as_shipped_) {
    scene = fmt::format("scene_path: '{}'", folder_.path());
    hand = "";
  }
  switch (who) {
    case Who::kRig:
      taps_.push_back(fmt::format("{}/rig{}.tap", folder_.path(), taps_.size() + 1));
      return fmt::format(
          "robot_port: {} sensor_port: {} repeatability_mm: 0 drop_share: {} mxttout_cycles: {} "
          "seed: {} tap: '{}'",
          robot_port_, sensor_port_, sequence_.loss, sequence_.time_out_cycles,
          sequence_.seed % 1'000'000 + taps_.size(), taps_.back());
    case Who::kSlave:
      return fmt::format("link_socket: '{}' robot {{ port: {} }} force_sensor {{ port: {} }} {}",
                         link_socket(), robot_port_, sensor_port_, scene);
    default:
      return fmt::format("link_socket: '{}' operator_socket: '{}' {} {}",
                         link_through_.empty() ? link_socket() : link_through_, socket(), scene,
                         hand);
  }
}

void Cell::pause(Who who) {
  send(who, SIGSTOP);
  program(who).paused = true;
}

void Cell::resume(Who who) {
  send(who, SIGCONT);
  program(who).paused = false;
}

int Cell::wait_for_end(Who who) {
  const Nanos give_up = monotonic_now() + kStartPatience;
  while (running(who)) {
    if (monotonic_now() > give_up) send(who, SIGKILL);
    sleep_until(monotonic_now() + kMillisecond);
  }
  return code(who);
}

std::string Cell::output(Who who) const { return program(who).child->output(); }

}  // namespace handrail::storm
