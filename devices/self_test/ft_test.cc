#include "devices/self_test/ft_test.h"

#include <cmath>
#include <cstdio>
#include <utility>

namespace handrail {
namespace {

constexpr Nanos kRestTime = 2 * kSecond;
constexpr Nanos kPressPatience = 15 * kSecond;
constexpr double kPressed = 3.0;  // above noise and payload of a small arm, easy by hand [N]
constexpr double kLetGo = 1.0;    // [N]
constexpr double kBesides = 1.5;  // the axis asked for feels so much more than any other
// A slave's loop of 7.1 ms should have a new record in each cycle.
constexpr double kLeastRecords = 141.0;  // [1/s]
constexpr double kMostMissed = 0.01;     // share of records
constexpr std::array kAxes = {"x", "y", "z"};

struct Press {
  const char* check;
  const char* asks;
  int axis;
  double sign;
};
// The wrench is what the environment exerts on the sensor, axes of the tip; z points out of it.
constexpr std::array kPresses = {
    Press{"press.in", "press the tip into the arm, along the tool", 2, -1.0},
    Press{"press.x", "push the tip along its x axis, forward", 0, 1.0},
    Press{"press.y", "push the tip along its y axis, forward", 1, 1.0},
};
constexpr int kOver = 1 + static_cast<int>(kPresses.size());

const Press& press_of(int phase) { return kPresses[static_cast<std::size_t>(phase - 1)]; }

template <typename... Values>
std::string in_words(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

FtTest::FtTest(std::unique_ptr<FtSensor> sensor, const TestWishes& wishes, std::string block)
    : sensor_(std::move(sensor)), block_(std::move(block)), alone_(wishes.alone) {}

bool FtTest::turn(Nanos now) {
  if (!started_) {
    started_ = true;
    began_ = phase_began_ = now;
  }
  FtSample sample;
  if (sensor_->poll(now, sample)) {
    if (sample.status != 0) {
      ++faults_;
      fault_ = sample.status;
    }
    if (phase_ == 0) {
      last_at_ = now;
      if (resting_ == 0) first_at_ = now;
      rest(sample);
    } else if (phase_ < kOver) {
      press(sample, now);
    }
  }
  if (phase_ == 0 && now - phase_began_ >= kRestTime) {
    silent_ = resting_ == 0;
    phase_ = silent_ || alone_ ? kOver : 1;
    phase_began_ = now;
  }
  if (phase_ > 0 && phase_ < kOver && now - phase_began_ >= kPressPatience) {
    end_press(Verdict::kNotSeen, "asked to " + asks() + ": under 3 N came in 15 s",
              "try anew; with --alone nothing is asked", now);
  }
  return phase_ < kOver;
}

void FtTest::rest(const FtSample& sample) {
  if (resting_ > 0) {
    const std::uint32_t ahead = sample.sequence - newest_;
    missed_ += ahead > 1 && ahead < 1u << 31 ? ahead - 1 : 0;
  }
  newest_ = sample.sequence;
  ++resting_;
  Six v;
  v << sample.wrench.force, sample.wrench.torque;
  sum_ += v;
  squares_ += v.cwiseProduct(v);
}

void FtTest::press(const FtSample& sample, Nanos now) {
  const Vec3 force = sample.wrench.force - mean().head<3>();
  if (!let_go_) {
    let_go_ = force.norm() < kLetGo;
    return;
  }
  int axis = 0;
  const double felt = force.cwiseAbs().maxCoeff(&axis);
  if (felt < kPressed) return;
  Vec3 rest = force;
  rest[axis] = 0.0;
  const std::string fact = in_words("felt %.1f, %.1f, %.1f N", force[0], force[1], force[2]);
  if (felt < kBesides * rest.cwiseAbs().maxCoeff()) {
    if (felt < 3.0 * kPressed) return;
    return end_press(Verdict::kNotSeen, "pressed aslant: " + fact,
                     "try anew, along one axis at a time", now);
  }
  const Press& asked = press_of(phase_);
  if (axis == asked.axis && force[axis] * asked.sign > 0.0) {
    return end_press(Verdict::kOk, fact, "", now);
  }
  const bool reversed = axis == asked.axis;
  end_press(Verdict::kBad,
            fact + ", expected " + (asked.sign < 0.0 ? "-" : "+") +
                kAxes[static_cast<std::size_t>(asked.axis)],
            reversed
                ? "its sign is reversed: it must tell what it feels, not what it exerts; turn its "
                  "frame in the sensor's own settings"
                : "turn its frame in the sensor's own settings until its axes are the tip's",
            now);
}

void FtTest::end_press(Verdict verdict, std::string fact, std::string next, Nanos now) {
  done_.push_back({press_of(phase_).check, verdict, std::move(fact), std::move(next)});
  let_go_ = false;
  phase_began_ = now;
  ++phase_;
}

std::string FtTest::asks() const {
  if (phase_ >= kOver) return {};
  if (phase_ == 0) return "leave the tip alone, clear of everything";
  return press_of(phase_).asks;
}

TestItem FtTest::records() const {
  if (resting_ == 0) {
    return {"records", started_ ? Verdict::kBad : Verdict::kNotSeen, "no record came",
            "is it powered, and the address right? does another program read it?"};
  }
  const double seconds = to_seconds(last_at_ - first_at_);
  const double rate = seconds > 0.0 ? static_cast<double>(resting_ - 1) / seconds : 0.0;
  // A poll gives the newest and leaves out what came with it: those are not lost.
  const double sent = rate + (seconds > 0.0 ? static_cast<double>(missed_) / seconds : 0.0);
  const bool slow = sent < kLeastRecords;
  return {"records", slow ? Verdict::kBad : Verdict::kOk,
          in_words("%.0f records a second by its own counter, %.0f of them taken; at least %.0f "
                   "expected",
                   sent, rate, kLeastRecords),
          slow ? "set its RDT output rate to 500 Hz or more" : ""};
}

TestItem FtTest::status() const {
  if (faults_ == 0) return {"status", Verdict::kOk, "no record reports a fault", ""};
  return {"status", Verdict::kBad,
          in_words("%llu records report a fault, the last 0x%08x",
                   static_cast<unsigned long long>(faults_), fault_),
          "look the number up in the sensor's manual; most often it is overloaded"};
}

TestItem FtTest::at_rest() const {
  const double n = static_cast<double>(resting_);
  const Six m = mean();
  const Six noise = (squares_ / n - m.cwiseProduct(m)).cwiseMax(0.0).cwiseSqrt();
  return {"rest", Verdict::kOk,
          in_words("load %.2f, %.2f, %.2f N and %.3f, %.3f, %.3f N m; noise %.3f N, %.4f N m rms",
                   m[0], m[1], m[2], m[3], m[4], m[5], noise.head<3>().maxCoeff(),
                   noise.tail<3>().maxCoeff()),
          "a load that the tool does not explain: handrail calibrate payload"};
}

std::vector<TestItem> FtTest::items() const {
  std::vector<TestItem> out = {records()};
  if (resting_ == 0) return out;
  out.push_back(status());
  out.push_back(at_rest());
  out.insert(out.end(), done_.begin(), done_.end());
  return out;
}

}  // namespace handrail
