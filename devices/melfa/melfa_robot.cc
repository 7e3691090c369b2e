#include "devices/melfa/melfa_robot.h"

#include <algorithm>

#include "devices/melfa/r3_socket.h"
#include "server/base/clock.h"

namespace handrail {
namespace {

// Room for a few replies only: old ones must not pile up behind a busy loop.
constexpr int kReceiveBuffer = 4096;
// Datagrams taken before the deadline is looked at again, so that a flood cannot hold the loop.
constexpr int kMaxDrain = 32;

}  // namespace

Obstacle why_silent(const MelfaOptions& options) {
  const auto line = R3Socket::connect(options.address, options.command_port);
  if (line) return silence_of(**line, options.program);
  Obstacle out = obstacle_in(line.message());
  out.fact = "its switches cannot be asked: " + out.fact;
  return out;
}

MelfaRobot::MelfaRobot(const MelfaOptions& options)
    : options_(options),
      capabilities_{"Mitsubishi MELFA, " + std::to_string(options.client.packet_bytes) +
                        "-byte real-time control",
                    options.client.period},
      client_(options.client) {}

MelfaRobot::~MelfaRobot() { end(); }

Status MelfaRobot::connect(Nanos patience, RobotReply& first) {
  const std::string who = "robot controller ";
  const std::size_t size = options_.client.packet_bytes;
  if (size != kMxtShort && size != kMxtLong) {
    return Status::error(who + "packet size " + std::to_string(size) +
                         ": expected 64 or 196 bytes");
  }
  end();
  if (Status s = socket_.open(options_.address, options_.port, kReceiveBuffer); !s) {
    return Status::error(who + s.message());
  }
  const MxtCounters before = client_.counters();
  const Nanos give_up = monotonic_now() + patience;
  socket_.send(client_.start(monotonic_now()));
  while (client_.open() && monotonic_now() < give_up) {
    if (wait_until(first, give_up) == RobotEvent::kReply) return Status::ok();
  }
  end();
  const std::uint64_t rejected = client_.counters().rejected - before.rejected;
  const std::string cause =
      client_.counters().far > before.far
          ? "answers come too late; the way there and back may take " +
                std::to_string(options_.client.longest_way() / kMicrosecond) + " us"
      : rejected > 0
          ? std::to_string(rejected) + " answers, none a joint reply of " + std::to_string(size) +
                " bytes; check packet_bytes"
          : "no answer; expected a controller in AUTOMATIC whose program has opened MXT for "
            "this computer's address";
  return Status::error(who + options_.address + ":" + std::to_string(options_.port) + ": " + cause);
}

RobotEvent MelfaRobot::wait(RobotReply& reply) noexcept { return wait_until(reply, kForever); }

RobotEvent MelfaRobot::wait_until(RobotReply& reply, Nanos until) noexcept {
  for (;;) {
    Nanos read_at = 0;  // all of them: one event at most comes of what is read together
    bool replied = false;
    bool rejected = false;
    for (int i = 0; i < kMaxDrain; ++i) {
      const std::optional<std::size_t> size = socket_.receive(buffer_);
      if (!size) break;
      if (i == 0) read_at = monotonic_now();
      const std::optional<RobotEvent> event =
          client_.on_datagram({buffer_.data(), *size}, read_at, reply);
      replied = replied || event == RobotEvent::kReply;
      rejected = rejected || event == RobotEvent::kRejected;
    }
    if (replied) return RobotEvent::kReply;
    const Nanos now = monotonic_now();
    if (const std::optional<RobotEvent> event = client_.poll(now, reply)) {
      if (client_.opening()) socket_.send(client_.packet());
      return *event;
    }
    if (rejected) return RobotEvent::kRejected;
    if (now >= until) return RobotEvent::kSilence;
    socket_.wait(std::min(client_.deadline(), until) - now);
  }
}

void MelfaRobot::send(const JointVector& q_target) noexcept {
  const auto bytes = client_.send(q_target, monotonic_now());
  if (!bytes.empty()) socket_.send(bytes);
}

void MelfaRobot::ask() noexcept {
  if (const auto bytes = client_.ask(); !bytes.empty()) socket_.send(bytes);
}

void MelfaRobot::end() noexcept {
  if (const auto bytes = client_.end(); !bytes.empty()) socket_.send(bytes);
  socket_.close();
}

}  // namespace handrail
