#include "client/cli/demo_command.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "client/cli/demo_drive.h"
#include "client/cli/interrupt.h"
#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/task/linear_measure.h"

namespace handrail {
namespace {

constexpr double kLeg = 75.0 * kMm;       // A to B and B to C, at the robot
constexpr double kOvershoot = 2.0 * kMm;  // the hand goes past the end, as hands do
constexpr double kTurn = 45.0;            // about the vertical through B [deg]
constexpr Nanos kDemoPatience = 2 * kSecond;
constexpr const char* kScene = "linear-movement";
// Where the rig's arm stands when it starts, and its tip points down: A.
const Pose kA{Vec3(350.0, 0.0, 429.0) * kMm, Quat(0.0, 0.0, 1.0, 0.0)};

// What one drive gave.
struct DriveResult {
  double time = 0.0;               // [s]
  double path = 0.0;               // [m]
  double position_error = 0.0;     // [m]
  double orientation_error = 0.0;  // [rad]
};

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

// Device right is -Y, up is +Z at the robot.
const Vec3 kRight(1.0, 0.0, 0.0);
const Vec3 kUp(0.0, 1.0, 0.0);
const Vec3 kDown = -kUp;
constexpr double kHandLeg = (kLeg / kDemoScale + kOvershoot) / kMm;

// One move of the hand, and the tools it is made with; each is called anew when it is repeated.
struct Leg {
  LinearPhase phase;
  std::vector<pb::Request> tools;
  Vec3 by_mm = Vec3::Zero();  // device axes
  Vec3 turn_deg = Vec3::Zero();
};

std::vector<Leg> legs_of(const LinearTask& task, bool tools) {
  std::vector<Leg> legs = {{LinearPhase::kToB, {}, kHandLeg * kRight},
                           {LinearPhase::kTurn, {}, Vec3::Zero(), kTurn * kUp},
                           {LinearPhase::kToC, {}, kHandLeg * kDown}};
  if (!tools) return legs;
  legs[0].tools = {line_to(-Vec3::UnitY(), task.p_SB), simple_tool(pb::Tool::N_ROTATION)};
  legs[1].tools = {simple_tool(pb::Tool::POINT), tools_off(false, true)};
  legs[2].tools = {simple_tool(pb::Tool::N_ROTATION), line_to(-Vec3::UnitZ(), task.p_SC)};
  return legs;
}

// A move after which the session was lost counts for nothing, and is made again from its start.
class Drive {
 public:
  Drive(DemoDriver& driver, const LinearTask& task, const Say& say)
      : driver_(driver), say_(say), measure_(task) {}

  void make(const Leg& leg) {
    const Pose start = pose_of(driver_.status().command());
    const LinearMeasure before = measure_;
    driver_.begin_move();
    do {
      measure_ = before;
      attempt(leg);
    } while (driver_.lost() && driver_.recover(start, say_));
  }
  DriveResult result() const {
    return {time_, measure_.path(), measure_.position_error(), measure_.orientation_error()};
  }

 private:
  void attempt(const Leg& leg) {
    const Nanos start = monotonic_now();
    for (const pb::Request& tool : leg.tools) driver_.order(tool);
    const pb::Status now = driver_.status();
    if (!driver_.ok()) return;
    measure_.begin(leg.phase, pose_of(now.tip()).q, pose_of(now.command()).q);
    const bool done = driver_.move(leg.by_mm, leg.turn_deg, [this](const pb::Status& s) {
      if (s.has_tip()) measure_.add(pose_of(s.tip()));
    });
    if (done) time_ += to_seconds(monotonic_now() - start);
  }

  DemoDriver& driver_;
  const Say& say_;
  LinearMeasure measure_;
  double time_ = 0.0;
};

DriveResult drive(DemoDriver& driver, bool tools, const Say& say) {
  const Pose X_SA = pose_of(driver.status().command());
  LinearTask task;
  task.p_SA = X_SA.p;
  task.p_SB = task.p_SA - kLeg * Vec3::UnitY();
  task.p_SC = task.p_SB - kLeg * Vec3::UnitZ();
  task.q_first = X_SA.q;
  task.turn = kTurn * kDeg * Vec3::UnitZ();
  Drive drive(driver, task, say);
  for (const Leg& leg : legs_of(task, tools)) drive.make(leg);
  if (tools) driver.order(tools_off(true, true));
  return drive.result();
}

// From wherever the arm is, as far as the hand leads it there.
void go_to_a(DemoDriver& driver, const Say& say) {
  driver.begin_move();
  if (driver.ok()) driver.drive_to(kA);
  if (driver.lost()) driver.recover(kA, say);
}

void print_row(const Console& console, const char* name, const char* unit, double without,
               double with) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), "  %-28s %10.2f %10.2f  %s\n", name, without, with, unit);
  console.out << text.data();
}

void print_table(const Console& console, const DriveResult& nv, const DriveResult& v,
                 const DemoDriver& driver, const pb::Status& status) {
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
                "haptic loop late p50 %.0f us, p99 %.0f us, p99.9 %.0f us, worst %.1f ms; %llu "
                "overruns in %llu ticks, %llu of the slave; oldest command applied %.1f ms\n",
                late.p50(), late.p99(), late.p999(), 1e-3 * late.max(),
                static_cast<unsigned long long>(status.overruns()),
                static_cast<unsigned long long>(status.ticks()),
                static_cast<unsigned long long>(status.slave_overruns()),
                status.oldest_applied_ms());
  console.out << text.data() << "the machine: " << driver.machine().text() << '\n';
  if (driver.losses() > 0) {
    console.out << "the session ended by itself " << driver.losses()
                << " times; those moves were made again\n";
  }
}

void print_json(const Console& console, const DriveResult& nv, const DriveResult& v,
                const DemoDriver& driver) {
  const auto one = [](const DriveResult& r) {
    std::array<char, 256> text;
    std::snprintf(text.data(), text.size(),
                  "{\"execution_time_s\": %.6g, \"path_mm\": %.6g, \"max_position_error_mm\": "
                  "%.6g, \"max_orientation_error_deg\": %.6g}",
                  r.time, r.path / kMm, r.position_error / kMm, r.orientation_error / kDeg);
    return std::string(text.data());
  };
  console.out << "{\"simulated\": true, \"without_tools\": " << one(nv)
              << ", \"with_tools\": " << one(v) << ", \"sessions_lost\": " << driver.losses()
              << ", \"pauses\": " << driver.machine().pauses()
              << ", \"longest_pause_ms\": " << 1e3 * to_seconds(driver.machine().longest())
              << ", \"stolen_s\": " << driver.machine().stolen_s() << "}\n";
}

// Moves and turns are those of this scene's mapping.
void check_scene(DemoDriver& driver) {
  const std::string scene = driver.status().scene();
  if (driver.ok() && scene != kScene) {
    driver.fail("scene '" + scene + "' is loaded, expected '" + kScene + "': handrail scene load " +
                kScene);
  }
}

bool disengage(const Options& options) {
  OperatorClient client(options.master, options.as);
  pb::Request request;
  request.set_disengage(true);
  return exit_code(client.call(request, kDemoPatience)) == kExitDone;
}

}  // namespace

ExitCode run_demo(const Options& options, const Console& console) {
  catch_interrupts();
  DemoDriver driver(options.master, options.as);
  const Say say = [&](const std::string& text) {
    if (!options.json && driver.code() == kExitDone) console.out << text << std::endl;
    if (!console.out) driver.fail("nobody reads what it prints");
  };
  check_scene(driver);
  if (driver.engage()) say("engaged; going to A ...");
  go_to_a(driver, say);
  say("driving A to B to C without tools ...");
  const DriveResult nv = drive(driver, false, say);
  say("going back to A ...");
  go_to_a(driver, say);
  say("driving A to B to C with a one-way line, N-rotation and the point tool ...");
  const DriveResult v = drive(driver, true, say);
  const pb::Status status = driver.status();
  say("going back to A ...");
  go_to_a(driver, say);
  // Whatever happened: nobody drives any more.
  const bool free = disengage(options);
  if (!console.out && free) return driver.code();  // main says why
  if (!driver.ok()) {
    console.err << "handrail: demo: " << driver.problem() << (free ? "; disengaged" : "") << '\n';
    return driver.code();
  }
  if (options.json) {
    print_json(console, nv, v, driver);
  } else {
    print_table(console, nv, v, driver, status);
  }
  return kExitDone;
}

}  // namespace handrail
