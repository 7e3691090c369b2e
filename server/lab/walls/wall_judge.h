// What every run among walls is judged by, and how every such run is asked for.
#pragma once

#include <atomic>
#include <vector>

#include "server/lab/walls/wall_watch.h"

namespace handrail {

struct WallRunOptions {
  bool traced = false;
  const std::atomic<bool>* cancelled = nullptr;  // ends the run early, its result then counts not

  bool is_cancelled() const { return cancelled != nullptr && cancelled->load(); }
};

struct WallRunResult {
  double inside_share = 1.0;    // of the hand's way
  double most_force = 0.0;      // on the handle, anywhere [N]
  double deepest = 0.0;         // into a wall [m]
  double share_of_bound = 0.0;  // PenetrationWatch
  double junction_ratio = 0.0;  // JunctionWatch
  double duration = 0.0;        // [s]
  std::vector<WallTick> trace;  // if asked for
};

inline constexpr double kWallSettle = 1.0;  // after what leads the hand has come to its end [s]

// Sees every tick of a run.
class WallJudge {
 public:
  // `bench` is about to run among `walls`, which meet within `reach` of `junctions`. All outlive
  // the judge.
  WallJudge(const Walls& walls, const WallBench& bench, const std::vector<Vec2>& junctions,
            double reach, const WallRunOptions& options)
      : penetration_(walls, bench.moving_mass()),
        junctions_(walls, junctions, reach),
        options_(options) {}

  void see(const WallTick& tick, WallRunResult& result);
  // After the last tick.
  void report(WallRunResult& result) const;

 private:
  PenetrationWatch penetration_;
  JunctionWatch junctions_;
  GuidanceWatch guidance_;
  const WallRunOptions& options_;
};

// A recorded hand to its end and a little longer; `see(tick)` hears what the judge does.
template <typename Run, typename See>
void play(const RecordedMotion& recording, WallBench& bench, WallJudge& judge,
          const WallRunOptions& options, Run& result, const See& see) {
  const double end = recording.duration() + kWallSettle;
  while (bench.now().t < end && !options.is_cancelled()) {
    WallTick tick = bench.step();
    tick.ball = tick.hand;
    judge.see(tick, result);
    see(tick);
  }
  judge.report(result);
}

}  // namespace handrail
