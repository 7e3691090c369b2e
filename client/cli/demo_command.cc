#include "client/cli/demo_command.h"

#include <poll.h>

#include <array>
#include <cstdio>
#include <functional>

#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/task/linear_measure.h"

namespace handrail {
namespace {

constexpr double kLeg = 75.0 * kMm;       // A to B and B to C, at the robot
constexpr double kScale = 2.0;            // hand to robot, as in the default scene
constexpr double kOvershoot = 2.0 * kMm;  // the hand goes past the end, as hands do
constexpr double kTurn = 45.0;            // about the vertical through B [deg]
constexpr double kMoveTime = 2.5;         // of one hand move [s]
constexpr Nanos kSettle = 800 * kMillisecond;
constexpr double kFollows = 5.0 * kMm;  // an arm further behind a hand at rest is held
constexpr int kSampleMs = 7;
constexpr Nanos kPatience = 5 * kSecond;

// What one drive gave.
struct DriveResult {
  double time = 0.0;               // [s]
  double path = 0.0;               // [m]
  double position_error = 0.0;     // [m]
  double orientation_error = 0.0;  // [rad]
};

// Talks to the master; the first failure is kept and ends everything after it.
class Driver {
 public:
  explicit Driver(const Options& options) : client_(options.socket, options.as) {}

  bool order(const pb::Request& request) {
    if (code_ != kExitDone) return false;
    const Result<pb::Reply> reply = client_.call(request, kPatience);
    code_ = exit_code(reply);
    if (code_ == kExitDone) return true;
    problem_ = reply ? "refused: " + reply->reason() : reply.message();
    return false;
  }

  bool status(pb::Status& out) {
    pb::Request request;
    request.set_status(true);
    if (code_ != kExitDone) return false;
    const Result<pb::Reply> reply = client_.call(request, kPatience);
    code_ = exit_code(reply);
    if (code_ != kExitDone) problem_ = reply ? "refused: " + reply->reason() : reply.message();
    if (code_ == kExitDone) out = reply->status();
    return code_ == kExitDone;
  }

  void fail(const std::string& problem) {
    if (code_ != kExitDone) return;
    code_ = kExitRefused;
    problem_ = problem;
  }

  bool ok() const { return code_ == kExitDone; }
  ExitCode code() const { return code_; }
  const std::string& problem() const { return problem_; }

 private:
  OperatorClient client_;
  ExitCode code_ = kExitDone;
  std::string problem_;
};

Pose pose_of(const pb::PoseMm& pose) {
  Pose X;
  if (pose.position_mm_size() != 3 || pose.quaternion_size() != 4) return X;
  X.p = kMm * Vec3(pose.position_mm(0), pose.position_mm(1), pose.position_mm(2));
  X.q = Quat(pose.quaternion(0), pose.quaternion(1), pose.quaternion(2), pose.quaternion(3));
  return X;
}

pb::Request hand_move(const Vec3& by_mm, const Vec3& turn_deg) {
  pb::Request request;
  request.mutable_hand()->mutable_displacement_mm()->Add(by_mm.begin(), by_mm.end());
  request.mutable_hand()->mutable_rotation_deg()->Add(turn_deg.begin(), turn_deg.end());
  request.mutable_hand()->set_duration_s(kMoveTime);
  return request;
}

pb::Request line_to(const Vec3& direction, const Vec3& end) {
  pb::Request request;
  pb::Tool& tool = *request.mutable_tool();
  tool.set_kind(pb::Tool::LINE);
  const Vec3 end_mm = end / kMm;
  tool.mutable_direction()->Add(direction.begin(), direction.end());
  tool.mutable_end_mm()->Add(end_mm.begin(), end_mm.end());
  tool.set_one_way(true);
  return request;
}

pb::Request simple_tool(pb::Tool::Kind kind) {
  pb::Request request;
  request.mutable_tool()->set_kind(kind);
  return request;
}

pb::Request tools_off(bool position, bool orientation) {
  pb::Request request;
  request.mutable_tool_off()->set_position(position);
  request.mutable_tool_off()->set_orientation(orientation);
  return request;
}

// Orders the move and samples the tip until hand and arm have come to rest. Hand in device axes.
void move(Driver& driver, const Vec3& by_mm, const Vec3& turn_deg, LinearMeasure* measure) {
  if (!driver.order(hand_move(by_mm, turn_deg))) return;
  Nanos still_since = -1;
  const Nanos give_up = monotonic_now() + 20 * kSecond;
  for (;;) {
    ::poll(nullptr, 0, kSampleMs);
    pb::Status status;
    if (!driver.status(status)) return;
    if (status.state() != "engaged" && status.state() != "hold") {
      return driver.fail("the session left '" + status.state() + "': " + status.reason());
    }
    if (measure != nullptr && status.has_tip()) measure->add(pose_of(status.tip()));
    const Nanos now = monotonic_now();
    if (status.hand_moving()) {
      still_since = -1;
    } else if (still_since < 0) {
      still_since = now;
    } else if (now - still_since > kSettle) {
      const double behind = (pose_of(status.command()).p - pose_of(status.tip()).p).norm();
      if (behind > kFollows) driver.fail("the arm could not follow: " + status.reason());
      return;
    }
    if (now > give_up) return driver.fail("the simulated hand did not come to rest");
  }
}

void begin(Driver& driver, LinearMeasure& measure, LinearPhase phase) {
  pb::Status status;
  if (!driver.status(status)) return;
  measure.begin(phase, pose_of(status.tip()).q, pose_of(status.command()).q);
}

// Device right is -Y, up is +Z at the robot.
const Vec3 kRight(1.0, 0.0, 0.0);
const Vec3 kUp(0.0, 1.0, 0.0);
const Vec3 kDown = -kUp;
constexpr double kHandLeg = (kLeg / kScale + kOvershoot) / kMm;

DriveResult drive(Driver& driver, bool tools) {
  pb::Status status;
  if (!driver.status(status)) return {};
  const Pose X_SA = pose_of(status.command());
  LinearTask task;
  task.p_SA = X_SA.p;
  task.p_SB = task.p_SA - kLeg * Vec3::UnitY();
  task.p_SC = task.p_SB - kLeg * Vec3::UnitZ();
  task.q_first = X_SA.q;
  task.turn = kTurn * kDeg * Vec3::UnitZ();
  LinearMeasure measure(task);
  const Nanos start = monotonic_now();

  if (tools) {
    driver.order(line_to(-Vec3::UnitY(), task.p_SB));
    driver.order(simple_tool(pb::Tool::N_ROTATION));
  }
  begin(driver, measure, LinearPhase::kToB);
  move(driver, kHandLeg * kRight, Vec3::Zero(), &measure);
  if (tools) {
    driver.order(simple_tool(pb::Tool::POINT));
    driver.order(tools_off(false, true));
  }
  begin(driver, measure, LinearPhase::kTurn);
  move(driver, Vec3::Zero(), kTurn * kUp, &measure);
  if (tools) {
    driver.order(simple_tool(pb::Tool::N_ROTATION));
    driver.order(line_to(-Vec3::UnitZ(), task.p_SC));
  }
  begin(driver, measure, LinearPhase::kToC);
  move(driver, kHandLeg * kDown, Vec3::Zero(), &measure);
  if (tools) driver.order(tools_off(true, true));
  return {to_seconds(monotonic_now() - start), measure.path(), measure.position_error(),
          measure.orientation_error()};
}

void go_back(Driver& driver) { move(driver, -kHandLeg * (kRight + kDown), -kTurn * kUp, nullptr); }

void print_row(const Console& console, const char* name, const char* unit, double without,
               double with) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), "  %-28s %10.2f %10.2f  %s\n", name, without, with, unit);
  console.out << text.data();
}

void print_table(const Console& console, const DriveResult& nv, const DriveResult& v,
                 const pb::Status& status) {
  console.out << "\nA to B to C, simulated hand on a simulated device, simulated arm\n"
              << "                                  without       with  tools\n";
  print_row(console, "execution time", "s", nv.time, v.time);
  print_row(console, "path of the tip", "mm", nv.path / kMm, v.path / kMm);
  print_row(console, "largest position error", "mm", nv.position_error / kMm,
            v.position_error / kMm);
  print_row(console, "largest orientation error", "deg", nv.orientation_error / kDeg,
            v.orientation_error / kDeg);
  const pb::Lateness& late = status.loop_lateness_us();
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(),
                "haptic loop late p50 %.0f us, p99 %.0f us, p99.9 %.0f us; %llu overruns in %llu "
                "ticks; oldest command applied %.1f ms\n",
                late.p50(), late.p99(), late.p999(),
                static_cast<unsigned long long>(status.overruns()),
                static_cast<unsigned long long>(status.ticks()), status.oldest_applied_ms());
  console.out << text.data();
}

void print_json(const Console& console, const DriveResult& nv, const DriveResult& v) {
  const auto one = [](const DriveResult& r) {
    std::array<char, 256> text;
    std::snprintf(text.data(), text.size(),
                  "{\"execution_time_s\": %.6g, \"path_mm\": %.6g, \"max_position_error_mm\": "
                  "%.6g, \"max_orientation_error_deg\": %.6g}",
                  r.time, r.path / kMm, r.position_error / kMm, r.orientation_error / kDeg);
    return std::string(text.data());
  };
  console.out << "{\"simulated\": true, \"without_tools\": " << one(nv)
              << ", \"with_tools\": " << one(v) << "}\n";
}

}  // namespace

ExitCode run_demo(const Options& options, const Console& console) {
  Driver driver(options);
  pb::Request engage, disengage;
  engage.set_engage(true);
  disengage.set_disengage(true);
  const auto say = [&](const char* text) {
    if (!options.json && driver.ok()) console.out << text << std::flush;
  };
  driver.order(engage);
  say("engaged; driving A to B to C without tools ...\n");
  const DriveResult nv = drive(driver, false);
  say("going back to A ...\n");
  go_back(driver);
  say("driving A to B to C with a one-way line, N-rotation and the point tool ...\n");
  const DriveResult v = drive(driver, true);
  pb::Status status;
  driver.status(status);
  say("going back to A ...\n");
  go_back(driver);
  driver.order(disengage);
  if (!driver.ok()) {
    console.err << "handrail: demo: " << driver.problem() << '\n';
    return driver.code();
  }
  if (options.json) {
    print_json(console, nv, v);
  } else {
    print_table(console, nv, v, status);
  }
  return kExitDone;
}

}  // namespace handrail
