#include "devices/melfa/melfa_driver.h"

#include <utility>

#include "devices/melfa/r3_socket.h"
#include "devices/self_test/finished_test.h"
#include "devices/self_test/robot_test.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr Nanos kFirstAnswer = 300 * kMillisecond;  // 42 cycles of the controller
constexpr Nanos kOpeningPatience = 2 * kSecond;
constexpr char kArmTaken[] = "another program of this computer speaks with it, a slave most likely";
constexpr char kAskItsSlave[] = "handrail status; or end the slave first";
constexpr char kHowToAnswer[] =
    "is it in AUTOMATIC, and does its program run that opens MXT for this computer's address? "
    "robot { address } in the slave's file";

std::string robot_block(const MelfaOptions& options) {
  return "robot { address: \"" + options.address + "\" port: " + std::to_string(options.port) +
         " packet_bytes: " + std::to_string(options.client.packet_bytes) + " }";
}

// What the controller's own switches say is in the way; none: nothing, or they cannot be reached.
Obstacle obstacle_at(const MelfaOptions& options) {
  const auto line = R3Socket::connect(options.address, options.command_port);
  if (!line) return {};
  const SwitchesReport seen = look_at_switches(**line, {options.program, std::nullopt});
  return seen.done ? seen.problem : Obstacle{};
}

}  // namespace

std::string MelfaDriver::place() const {
  return options_.address + ":" + std::to_string(options_.port);
}

// The size of what answers a packet of `size` bytes; none: nothing does.
std::optional<std::size_t> MelfaDriver::answers(std::size_t size) const {
  UdpClient socket;
  if (!socket.open(options_.address, options_.port, 4096)) return std::nullopt;
  MxtPacket question;
  question.type[0] = MxtType::kFeedbackJoint;
  std::array<std::uint8_t, kMxtLong> out{};
  socket.send(encode_mxt(question, size, out));
  const Nanos until = monotonic_now() + kFirstAnswer;
  for (Nanos now = monotonic_now(); now < until; now = monotonic_now()) {
    socket.wait(until - now);
    std::array<std::uint8_t, kMxtLong + 1> bytes{};
    const auto came = socket.receive(bytes);
    MxtPacket reply;
    if (came && decode_mxt_reply({bytes.data(), *came}, reply) == MxtParse::kOk) return came;
  }
  return std::nullopt;
}

std::vector<Sighting> MelfaDriver::probe() {
  if (taken_) return {{place(), Readiness::kReady, kArmTaken, kAskItsSlave}};
  const std::size_t wanted = options_.client.packet_bytes;
  for (const std::size_t size : {wanted, kMxtShort + kMxtLong - wanted}) {
    const auto came = answers(size);
    if (!came) continue;
    const std::string fact = "answers with " + std::to_string(*came) + " bytes";
    if (*came == wanted) return {{place(), Readiness::kReady, fact, ""}};
    return {{place(), Readiness::kUnfinished, fact + ", configured are " + std::to_string(wanted),
             "robot { packet_bytes: " + std::to_string(*came) + " } in the slave's file"}};
  }
  if (const Obstacle o = obstacle_at(options_); !o.none()) {
    return {{place(), Readiness::kUnfinished, "no answer to real-time control: " + o.fact, o.next}};
  }
  return {{place(), Readiness::kAbsent, "no answer to real-time control", kHowToAnswer}};
}

std::vector<TestItem> MelfaDriver::switches() const {
  const auto line = R3Socket::connect(options_.address, options_.command_port);
  if (!line)
    return {{"switches", Verdict::kNotSeen, obstacle_in(line.message()).fact,
             obstacle_in(line.message()).next}};
  const SwitchesReport seen = look_at_switches(**line, {options_.program, std::nullopt});
  if (!seen.done) {
    return {{"switches", Verdict::kNotSeen, seen.problem.fact, seen.problem.next}};
  }
  if (!seen.problem.none()) {
    return {{"switches", Verdict::kBad, seen.problem.fact, seen.problem.next}};
  }
  return {{"switches", Verdict::kOk,
           "automatic, servos on, program '" + shown(seen.before->program) + "' runs, override " +
               std::to_string(seen.before->override_percent) + " %",
           ""}};
}

StartedTest MelfaDriver::test(const TestWishes&) {
  if (taken_)
    return Status::error("robot controller: " + std::string(kArmTaken) + "; " + kAskItsSlave);
  auto robot = std::make_unique<MelfaRobot>(options_);
  RobotReply first;
  if (const Status s = robot->connect(kOpeningPatience, first); !s) {
    const Obstacle o = obstacle_at(options_);
    if (o.none()) return s;
    return Status::error("robot controller " + place() +
                         ": no answer to real-time control: " + o.fact + "; " + o.next);
  }
  return StartedTest(
      std::make_unique<RobotTest>(std::move(robot), first, robot_block(options_), switches()));
}

StartedTest MelfaDriver::calibrate() {
  if (taken_)
    return Status::error("robot controller: " + std::string(kArmTaken) + "; " + kAskItsSlave);
  MelfaOptions found = options_;
  for (const std::size_t size : {kMxtLong, kMxtShort}) {
    const auto came = answers(size);
    if (!came) continue;
    found.client.packet_bytes = *came;
    std::vector<TestItem> items = {
        {"packet_bytes", Verdict::kOk,
         "a packet of " + std::to_string(size) + " bytes is answered with " + std::to_string(*came),
         ""}};
    return StartedTest(std::make_unique<FinishedTest>(std::move(items), robot_block(found)));
  }
  return Status::error("robot controller " + place() + ": no answer to real-time control; " +
                       kHowToAnswer);
}

}  // namespace handrail
