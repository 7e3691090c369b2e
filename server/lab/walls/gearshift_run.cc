#include "server/lab/walls/gearshift_run.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "server/lab/walls/gear_driver.h"
#include "server/lab/walls/gear_judge.h"

namespace handrail {
namespace {

void hear(const GearGate& gate, const WallTick& tick, std::vector<GearEvent>& out) {
  for (int i = 0; i < tick.effects.event_count; ++i) {
    const EffectEvent& event = tick.effects.events[static_cast<std::size_t>(i)];
    GearEvent told;
    told.t = tick.t;
    told.gear = "N";
    if (event.kind == EffectEvent::Kind::kReturned) told.kind = GearEvent::Kind::kReturn;
    if (event.kind == EffectEvent::Kind::kUnlocked) told.kind = GearEvent::Kind::kUnlock;
    if (event.kind != EffectEvent::Kind::kReturned) {
      told.gear = gate.names()[static_cast<std::size_t>(event.place)];
    }
    out.push_back(std::move(told));
  }
}

}  // namespace

const char* name_of(GearEvent::Kind kind) noexcept {
  switch (kind) {
    case GearEvent::Kind::kLock: return "lock";
    case GearEvent::Kind::kUnlock: return "unlock";
    case GearEvent::Kind::kReturn: break;
  }
  return "return";
}

Result<GearGate> GearGate::of(const Scene& scene) {
  const EffectSpec* detent = effect_of(scene, EffectKind::kDetent);
  const EffectSpec* spring = effect_of(scene, EffectKind::kReturn);
  if (scene.walls == nullptr || detent == nullptr || spring == nullptr) {
    return Status::error("scene '" + scene.name +
                         "' lists no detent and return spring to shift gears with");
  }
  GearGate gate;
  gate.places_ = detent->places;
  gate.names_ = detent->place_names;
  gate.neutral_ = spring->at;
  gate.home_ = spring->radius;
  return gate;
}

std::vector<Vec2> GearGate::junctions() const {
  std::vector<Vec2> out;
  for (const Vec2& place : places_) {
    const Vec2 foot(place.x(), neutral_.y());
    if (std::find(out.begin(), out.end(), foot) == out.end()) out.push_back(foot);
  }
  return out;
}

double GearGate::junction_reach() const {
  const std::vector<Vec2> feet = junctions();
  const std::vector<Vec2>& others = feet.size() > 1 ? feet : places_;
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2& foot : feet) {
    for (const Vec2& other : others) {
      if (other != foot) least = std::min(least, (other - foot).norm());
    }
  }
  return 0.5 * least;
}

std::vector<Vec2> GearGate::way(const Vec2& a, const Vec2& b) const {
  std::vector<Vec2> out = {a};
  if (a.x() != b.x()) {
    for (const double x : {a.x(), b.x()}) {
      const Vec2 foot(x, neutral_.y());
      if (foot != out.back()) out.push_back(foot);
    }
  }
  if (b != out.back() || out.size() == 1) out.push_back(b);
  return out;
}

GearshiftResult shift_gears(const Scene& scene, const GearGate& gate, const JoystickPerson& person,
                            const WallRunOptions& options) {
  WallBench bench(scene, person.hand);
  WallJudge judge(*scene.walls, bench, gate.junctions(), gate.junction_reach(), options);
  GearJudge gears(gate);
  GearDriver driver(gate, person.pace);
  GearshiftResult result;
  double done = 0.0;  // when the driver was
  while (!(driver.done() && bench.now().t > done + kWallSettle) && !options.is_cancelled()) {
    if (driver.lets_go()) {
      bench.let_go();
    } else {
      bench.follow(driver.p(), driver.v());
    }
    WallTick tick = bench.step();
    if (!driver.done()) done = tick.t;
    driver.drive(tick);
    tick.ball = driver.p();
    judge.see(tick, result);
    gears.see(tick);
    hear(gate, tick, result.events);
  }
  judge.report(result);
  result.visited = gears.visited();
  return result;
}

GearshiftResult shift_gears(const Scene& scene, const GearGate& gate, const JoystickPerson& person,
                            const RecordedMotion& recording, const WallRunOptions& options) {
  WallBench bench(scene, person.hand, recording, gate.neutral());
  WallJudge judge(*scene.walls, bench, gate.junctions(), gate.junction_reach(), options);
  GearJudge gears(gate);
  GearshiftResult result;
  play(recording, bench, judge, options, result, [&](const WallTick& tick) {
    gears.see(tick);
    hear(gate, tick, result.events);
  });
  result.visited = gears.visited();
  return result;
}

}  // namespace handrail
