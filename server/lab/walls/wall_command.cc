#include "server/lab/walls/wall_command.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "devices/hand/recorded_hand_io.h"
#include "server/base/output.h"
#include "server/base/units.h"
#include "server/lab/console/console.h"
#include "server/lab/study/parallel.h"
#include "server/lab/walls/painted_twin.h"
#include "server/lab/walls/wall_drawing.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// What both commands begin with.
struct Setup {
  Scene scene;
  std::optional<RecordedMotion> hand;
};

Result<Setup> setup_of(const WallCommand& command) {
  auto scene = SceneLibrary().load(command.scene);
  if (!scene) return scene.status();
  Setup setup;
  setup.scene = std::move(*scene);
  for (EffectSpec& effect : setup.scene.effects) {
    effect.published_damper = effect.published_damper || command.published_damper;
  }
  if (command.walls != "exact") {
    if (!setup.scene.walls || setup.scene.walls->shapes.empty()) {
      return Status::error("--walls " + command.walls + ": scene '" + command.scene +
                           "' has no drawn walls to paint");
    }
    const WallMethod method =
        command.walls == "published" ? WallMethod::kPublished : WallMethod::kSubpixel;
    setup.scene.walls = std::make_shared<const Walls>(
        painted_twin(*setup.scene.walls, command.pixel * kMm, method));
  }
  if (command.hand.empty()) return setup;
  if (command.operators != 1) {
    return Status::error("--hand is one hand: leave out --operators");
  }
  auto hand = load_recorded_motion(command.hand);
  if (!hand) return hand.status();
  constexpr double kReach = 0.25;  // [m]
  const Vec3& half = hand->half_extent();
  if (half.x() > kReach || half.y() > kReach) {
    return Status::error(command.hand + ": covers more than " +
                         std::to_string(static_cast<int>(2e3 * kReach)) +
                         " mm, which no joystick does");
  }
  setup.hand = std::move(*hand);
  return setup;
}

// Runs everybody, with progress on terminals. False when cancelled.
bool run_all(const WallCommand& command, const std::function<void(std::size_t)>& job,
             const std::atomic<bool>& cancelled) {
  Progress progress;
  const bool done = run_parallel(
      static_cast<std::size_t>(command.operators), command.threads, job,
      [&](std::size_t count) {
        progress.show(std::to_string(count) + " of " + std::to_string(command.operators) +
                      " operators");
      },
      &cancelled);
  return done && !cancelled;
}

WallHeader header_of(const WallCommand& command) {
  WallHeader header;
  header.scene = command.scene;
  header.seed = command.seed;
  header.hand = command.hand;
  if (command.walls != "exact") {
    header.walls = fmt::format("{} of pixels of {:g} mm",
                               command.walls == "published" ? "Algorithm 1" : "sub-pixel surface",
                               command.pixel);
  }
  if (command.published_damper) {
    header.walls += header.walls.empty() ? "exact, as drawn" : "";
    header.walls += ", the damper of (2.1) to the letter";
  }
  return header;
}

bool traced(const WallCommand& command, std::size_t person) {
  return person == 0 && !(command.figures.empty() && command.traces.empty());
}

Status write_trace(const WallCommand& command, const std::vector<WallTick>& trace) {
  if (command.traces.empty()) return Status::ok();
  return write_file(command.traces, trace_csv(trace));
}

// Prints, and writes what is asked for. The exit code.
int finish(const WallCommand& command, const std::string& text, const std::vector<WallTick>& trace,
           const std::function<Status()>& draw) {
  std::fputs(text.c_str(), stdout);
  if (const Status s = write_trace(command, trace); !s) return complain(s, kFailed);
  if (command.figures.empty()) return kDone;
  const Status drawn = draw();
  return drawn ? kDone : complain(drawn, kFailed);
}

}  // namespace

int run_wrench_command(const WrenchCommand& command, const std::atomic<bool>& cancelled) {
  auto setup = setup_of(command);
  if (!setup) return complain(setup.status(), kUsage);
  Scene& scene = setup->scene;
  const auto path = WrenchPath::of(scene);
  if (!path) return complain(path.status(), kUsage);
  WallHeader header = header_of(command);
  for (EffectSpec& effect : scene.effects) {
    if (effect.kind != EffectKind::kProgressive) continue;
    effect.c = command.c.value_or(effect.c);
    header.c = effect.c;
  }
  header.turns = command.turns;
  header.loosen = command.loosen;
  header.radius = path->radius();

  std::vector<WrenchResult> people(static_cast<std::size_t>(command.operators));
  const auto job = [&](std::size_t i) {
    WrenchOptions options;
    options.turns = command.turns;
    options.loosen = command.loosen;
    options.traced = traced(command, i);
    options.cancelled = &cancelled;
    const JoystickPerson person = joystick_person(command.seed, static_cast<int>(i));
    people[i] = setup->hand ? turn_wrench(scene, *path, person, *setup->hand, options)
                            : turn_wrench(scene, *path, person, options);
  };
  if (!run_all(command, job, cancelled)) return complain(Status::error("cancelled"), kCancelled);
  const std::string text =
      command.json ? wrench_json(header, people) : wrench_table(header, people);
  return finish(command, text, people[0].trace,
                [&] { return draw_wrench(command.figures, header, *scene.walls, *path, people); });
}

int run_gearshift_command(const GearshiftCommand& command, const std::atomic<bool>& cancelled) {
  auto setup = setup_of(command);
  if (!setup) return complain(setup.status(), kUsage);
  const auto gate = GearGate::of(setup->scene);
  if (!gate) return complain(gate.status(), kUsage);
  const WallHeader header = header_of(command);

  std::vector<GearshiftResult> people(static_cast<std::size_t>(command.operators));
  const auto job = [&](std::size_t i) {
    WallRunOptions options;
    options.traced = traced(command, i);
    options.cancelled = &cancelled;
    const JoystickPerson person = joystick_person(command.seed, static_cast<int>(i));
    people[i] = setup->hand ? shift_gears(setup->scene, *gate, person, *setup->hand, options)
                            : shift_gears(setup->scene, *gate, person, options);
  };
  if (!run_all(command, job, cancelled)) return complain(Status::error("cancelled"), kCancelled);
  const std::string text =
      command.json ? gearshift_json(header, people) : gearshift_table(header, people);
  return finish(command, text, people[0].trace, [&] {
    return draw_gearshift(command.figures, header, *setup->scene.walls, *gate, people);
  });
}

}  // namespace handrail
