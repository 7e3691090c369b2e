#include "tests/links/cell.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include "client/cli/interrupt.h"
#include "devices/rig/tap.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/random.h"
#include "server/base/units.h"
#include "server/keys/key_folder.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/links/stroke_speed.h"
#include "server/model/scene.h"
#include "tests/links/outcome.h"
#include "tests/storm/judge.h"
#include "tests/support/child.h"

namespace handrail::links {
namespace {

constexpr double kSample = 0.01;  // [s]
constexpr double kJump = 0.02;    // a stroke of the hand [s]: 10 m/s, the arm makes 0.8
constexpr double kBefore = 0.2;   // the tip is looked at from so long before the hand leaves [s]

double stroke_span(const LinkCase& link) {
  return to_seconds(StrokeSpeed::kStrokeTime) + 2e-3 * (link.delay_ms + link.jitter_ms);
}

std::string sines(const RunPlan& plan, std::uint64_t seed) {
  Random random(seed);
  std::array<double, 9> hand{};
  for (std::size_t k = 0; k < 3; ++k) {
    hand[k] = 18.0 * (0.5 + 0.5 * random.uniform());
    hand[k + 3] = 2.0 * std::numbers::pi * (0.3 + 0.6 * random.uniform());
    hand[k + 6] = 2.0 * std::numbers::pi * random.uniform();
  }
  std::string out;
  // Until both programs are up, while it is tried to engage, and an operator's pauses.
  const double end = 30.0 + plan.engage_s + plan.drive_s;
  for (double t = 0.0; t < end; t += kSample) {
    out += fmt::format("{:.2f}", t);
    for (std::size_t k = 0; k < 3; ++k) {
      out += fmt::format(",{:.4f}", hand[k] * std::sin(hand[k + 3] * t + hand[k + 6]));
    }
    out += '\n';
  }
  return out;
}

std::string strokes(const RunPlan& plan, const LinkCase& link) {
  const double half = StrokeSpeed::kHalfStroke / kMm;
  std::string out;
  int next = 0;
  double place = 0.0;
  const double end = strokes_end(plan, link);
  for (double t = 0.0; t < end; t += kSample) {
    if (t > stroke_start(plan, link, next) + kJump - 1e-9) {
      place = next % 2 == 0 ? half : -half;
      ++next;
    }
    out += fmt::format("{:.2f},{:.1f},0,0\n", t, place);
  }
  return out;
}

Status make_keys(const std::string& folder) {
  const KeyFolder slave(folder + "/slave-keys"), master(folder + "/master-keys");
  const auto cell = slave.create("cell", Role::kSlave), desk = master.create("desk", Role::kMaster);
  if (!cell) return cell.status();
  if (!desk) return desk.status();
  TrustList masters, slaves;
  (void)masters.add(desk->entry());
  (void)slaves.add(cell->entry());
  if (Status saved = slave.save(masters, "links"); !saved) return saved;
  return master.save(slaves, "links");
}

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}
std::string text_of_file(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

// Every place of the tip between two moments, one a cycle of the controller, from the encoders.
std::vector<Vec3> tip_between(const TapFile& tap, Nanos from, Nanos to) {
  ArmGeometry arm;
  arm.d6 = Scene().tip_length;
  std::vector<Vec3> out;
  for (const TapRecord& record : tap.records) {
    if (record.at < from || record.at >= to) continue;
    JointVector q;
    std::copy(record.measured.begin(), record.measured.end(), q.data());
    out.push_back(forward(arm, q).p);
  }
  return out;
}

double speed_of(const TapFile& tap, const RunPlan& plan, const LinkCase& link,
                const NearOutcome& near) {
  StrokeSpeed speed;
  const auto moment = [&](double t) { return near.started + static_cast<Nanos>(t * 1e9); };
  for (int i = 1; i <= plan.strokes; ++i) {  // the first is half a stroke
    const double start = stroke_start(plan, link, i) - kBefore;
    if (moment(start) < near.engaged_at) continue;
    speed.add(tip_between(tap, moment(start), moment(start + stroke_span(link))),
              to_seconds(tap.period));
  }
  return speed.mean() / kMm;
}

Result<LinkFigures> figures_of(const RunPlan& plan, const LinkCase& link,
                               const std::string& folder) {
  const auto near = read_outcome(text_of_file(folder + "/near.outcome"));
  if (!near) {
    return Status::error(near.message() + "; what the programs said is in " + folder);
  }
  LinkFigures out;
  out.engaged = near->engaged_at > 0;
  if (!out.engaged) return out;
  out.after = to_seconds(near->engaged_at - near->launched);
  const auto tap = read_tap(folder + "/rig.tap");
  if (!tap) return tap.status();
  std::vector<storm::Violation> violations;
  (void)storm::judge_tap(*tap, {}, violations);
  out.violations = violations.size();
  if (plan.motion == Motion::kStrokes) {
    out.speed = speed_of(*tap, plan, link, *near);
    return out;
  }
  const double minutes = to_seconds(near->ended - near->engaged_at) / 60.0;
  out.ends = near->ends / minutes;
  out.behind = near->behind;
  const Status read = read_holds(text_of_file(folder + "/slave.out"), out, minutes);
  return read ? Result<LinkFigures>(out) : Result<LinkFigures>(read);
}

}  // namespace

double stroke_start(const RunPlan& plan, const LinkCase& link, int i) {
  return 2.0 + plan.engage_s + i * stroke_span(link);
}

double strokes_end(const RunPlan& plan, const LinkCase& link) {
  return stroke_start(plan, link, plan.strokes + 1);
}

std::string hand_recording(const RunPlan& plan, const LinkCase& link) {
  return "t_s,x_mm,y_mm,z_mm\n" +
         (plan.motion == Motion::kSines ? sines(plan, link.seed) : strokes(plan, link));
}

std::string network_text(const LinkCase& link) {
  return fmt::format("both {{ delay_ms: {:g} jitter_ms: {:g} loss: {:g} reorder: {} }}",
                     link.delay_ms, link.jitter_ms, link.loss, link.in_order ? 0 : 1);
}

Status read_holds(const std::string& log, LinkFigures& out, double minutes) {
  const std::string before = "the arm stood for the link's sake ";
  const std::size_t at = log.rfind(before);
  int times = 0;
  double held = 0.0, longest = 0.0;
  if (at == std::string::npos ||
      std::sscanf(log.c_str() + at + before.size(), "%d times, for %lf s in all, %lf s at most",
                  &times, &held, &longest) != 3) {
    return Status::error("the slave's log does not say how often the arm stood");
  }
  out.holds = times / minutes;
  out.held = held / (60.0 * minutes);
  out.longest = 1e3 * longest;
  return Status::ok();
}

Result<LinkFigures> measure(const RunPlan& plan, const LinkCase& link, const std::string& folder) {
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  if (!std::filesystem::create_directories(folder, error)) {
    return Status::error(folder + ": " + error.message() + ", expected a folder that can be made");
  }
  ::chmod(folder.c_str(), 0700);  // keys are in it
  if (const Status made = make_keys(folder); !made) return made;
  write(folder + "/links.scene", "name: 'links'\n");
  write(folder + "/hand.csv", hand_recording(plan, link));
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const bool strokes = plan.motion == Motion::kStrokes;
  const double drive = strokes ? strokes_end(plan, link) : plan.drive_s;
  Child netfault("handrail-netfault",
                 {"--seed",
                  std::to_string(link.seed),
                  "--set",
                  network_text(link),
                  "--share",
                  folder,
                  "--json",
                  "--until",
                  "both",
                  "--",
                  "near:",
                  self,
                  "--near",
                  folder,
                  strokes ? "strokes" : "sines",
                  fmt::format("{:g}", plan.engage_s),
                  fmt::format("{:g}", drive),
                  "--",
                  "far:",
                  self,
                  "--far",
                  folder},
                 folder + "/netfault.out");
  const Nanos give_up = monotonic_now() + static_cast<Nanos>(1e9 * (60.0 + plan.engage_s + drive));
  while (netfault.running()) {
    if (interrupted()) return Status::error("interrupted");
    if (monotonic_now() > give_up) {
      return Status::error("it does not end; what the programs said is in " + folder);
    }
    sleep_until(monotonic_now() + 20 * kMillisecond);
  }
  if (netfault.code() != 0) {
    const std::string said = netfault.output();
    return Status::error(
        fmt::format("handrail-netfault ended with {}: {}", netfault.code(), said.substr(0, 400)));
  }
  return figures_of(plan, link, folder);
}

}  // namespace handrail::links
