#include "server/lab/walls/wrench_run.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kJunctionReach = 1.5;  // widths of the aisle

bool turning(const Walls& walls, const WallTick& tick) {
  return walls.regions[tick.contact.region].progressive;
}

WallJudge judge_of(const Scene& scene, const WrenchPath& path, const WallBench& bench,
                   const WrenchOptions& options) {
  return {*scene.walls, bench, {path.begin(), path.end()}, kJunctionReach * path.width(), options};
}

// Visits of the semi-circle that turned far enough.
class Visits {
 public:
  explicit Visits(double least) : least_(least) {}
  void see(bool turning, const WallTick& tick, std::vector<WrenchTurn>& turns) {
    if (turning && !inside_) peak_ = 0.0, before_ = tick.turned;
    if (turning) peak_ = std::max(peak_, tick.handle.norm());
    if (!turning && inside_ && std::abs(tick.turned - before_) >= least_) {
      turns.push_back({peak_, tick.turned});
    }
    inside_ = turning;
  }

 private:
  double least_;  // [rad]
  bool inside_ = false;
  double peak_ = 0.0, before_ = 0.0;
};

}  // namespace

double growth_of(const WrenchResult& result, int tightening) {
  const auto n = std::min(static_cast<std::size_t>(std::max(tightening, 0)), result.turns.size());
  if (n < 2) return 0.0;
  const double middle = 0.5 * static_cast<double>(n - 1);
  double up = 0.0, across = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i) - middle;
    up += x * result.turns[i].peak;
    across += x * x;
  }
  return up / across;
}

double distance_from_real(const WrenchResult& result, int tightening) {
  double most = 0.0;
  for (std::size_t i = 0; i < result.turns.size() && static_cast<int>(i) < tightening; ++i) {
    most = std::max(most, result.turns[i].peak);
  }
  return std::abs(kRealWrench - most);
}

WrenchResult turn_wrench(const Scene& scene, const WrenchPath& path, const JoystickPerson& person,
                         const WrenchOptions& options) {
  WallBench bench(scene, person.hand);
  WallJudge judge = judge_of(scene, path, bench, options);
  GuidingBall ball(path, options.turns, options.loosen);
  WrenchResult result;
  result.turns.resize(static_cast<std::size_t>(options.turns + options.loosen));
  const int last = static_cast<int>(result.turns.size()) - 1;
  const double end = ball.duration() + kWallSettle;
  while (bench.now().t < end && !options.is_cancelled()) {
    const WallTick& before = bench.now();
    ball.move(before.t, before.hand);
    bench.follow(ball.p(), ball.v());
    WallTick tick = bench.step();
    tick.ball = ball.p();
    judge.see(tick, result);
    if (const int loop = std::min(ball.loop(tick.t), last); loop >= 0) {
      WrenchTurn& turn = result.turns[static_cast<std::size_t>(loop)];
      if (turning(*scene.walls, tick)) turn.peak = std::max(turn.peak, tick.handle.norm());
      turn.alpha = tick.turned;
    }
  }
  judge.report(result);
  return result;
}

WrenchResult turn_wrench(const Scene& scene, const WrenchPath& path, const JoystickPerson& person,
                         const RecordedMotion& recording, const WrenchOptions& options) {
  WallBench bench(scene, person.hand, recording, path.middle());
  WallJudge judge = judge_of(scene, path, bench, options);
  Visits visits(0.25 * path.turn_length() / path.radius());
  WrenchResult result;
  play(recording, bench, judge, options, result,
       [&](const WallTick& tick) { visits.see(turning(*scene.walls, tick), tick, result.turns); });
  return result;
}

}  // namespace handrail
