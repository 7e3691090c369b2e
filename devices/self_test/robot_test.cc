#include "devices/self_test/robot_test.h"

#include <cstdio>
#include <utility>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr Nanos kRobotWatch = 3 * kSecond;
// An engage asks for a link with less; a cable that loses more is broken.
constexpr double kMostSilent = 0.01;      // share of cycles
constexpr double kStands = 0.05 * kDeg;   // a servo that holds stays within it [rad]
constexpr double kMostCycleError = 0.05;  // share of the cycle; the PC's clock is far better

template <typename... Values>
std::string line_of(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

RobotTest::RobotTest(std::unique_ptr<Robot> robot, const RobotReply& first, std::string block,
                     std::vector<TestItem> known)
    : robot_(std::move(robot)),
      block_(std::move(block)),
      known_(std::move(known)),
      reply_(first),
      least_(first.q_measured),
      most_(first.q_measured) {}

bool RobotTest::turn(Nanos now) {
  if (!started_) {
    started_ = true;
    began_ = last_ = now;
  }
  switch (robot_->wait(reply_)) {
    case RobotEvent::kReply: ++replies_; break;
    case RobotEvent::kSilence: ++silences_; break;
    case RobotEvent::kRejected: ++rejected_; return now - began_ < kRobotWatch;
    case RobotEvent::kLost: lost_ = true; return false;
  }
  if (reply_.has_measured) {
    least_ = least_.cwiseMin(reply_.q_measured);
    most_ = most_.cwiseMax(reply_.q_measured);
  }
  robot_->ask();
  last_ = now;
  return now - began_ < kRobotWatch;
}

std::vector<TestItem> RobotTest::items() const {
  std::vector<TestItem> out = known_;
  const double cycles = static_cast<double>(replies_ + silences_);
  const double silent = cycles > 0.0 ? static_cast<double>(silences_) / cycles : 1.0;
  if (lost_ || replies_ == 0) {
    out.push_back({"answers", Verdict::kBad, "the controller fell silent",
                   "did its program end, or an alarm come? look at the teaching pendant"});
    return out;
  }
  out.push_back(
      {"answers", silent > kMostSilent ? Verdict::kBad : Verdict::kOk,
       line_of("%.1f %% of %.0f cycles without an answer in time, %llu packets of "
               "another kind; at most 1 %% expected",
               100.0 * silent, cycles, static_cast<unsigned long long>(rejected_)),
       silent > kMostSilent ? "look at the network between, and at this computer's load" : ""});
  const double cycle = to_seconds(last_ - began_) / (cycles - 1.0);
  const double stated = to_seconds(robot_->capabilities().period);
  const bool other = cycles < 2.0 || std::abs(cycle - stated) > kMostCycleError * stated;
  out.push_back({"cycle", other ? Verdict::kBad : Verdict::kOk,
                 line_of("%.3f ms, expected %.3f ms", 1e3 * cycle, 1e3 * stated),
                 other ? "this driver knows controllers of that cycle alone" : ""});
  std::string joints;
  for (int i = 0; i < 6; ++i) {
    joints += line_of("%s%.2f", i == 0 ? "" : ", ", reply_.q_measured[i] / kDeg);
  }
  const double moved = (most_ - least_).maxCoeff();
  out.push_back(
      {"joints", moved > kStands ? Verdict::kBad : Verdict::kOk,
       joints + line_of(" deg; moved within %.3f deg, at most 0.05 expected", moved / kDeg),
       moved > kStands ? "something else moves the arm: end it first" : ""});
  return out;
}

}  // namespace handrail
