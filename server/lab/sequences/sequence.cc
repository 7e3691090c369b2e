#include "server/lab/sequences/sequence.h"

#include <memory>
#include <vector>

#include "devices/omni/omni_data.h"
#include "server/lab/sequences/hand_course.h"
#include "server/lab/sequences/surface_course.h"
#include "server/lab/sequences/tip_stand_in.h"
#include "server/lab/sequences/tool_draw.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr double kTick = 1e-3;                           // [s]
constexpr double kLongestStep = 5e-3;                    // as the haptic loop's [s]
constexpr std::uint64_t kSurfaces = 0x5375726661636573;  // chosen: numbers of their own
constexpr double kOrderEvery = 0.04;                     // mean, chosen: some twenty a sequence [s]

std::vector<HapticSettings> all_settings() {
  std::vector<HapticSettings> out;
  for (const double scale : {1.0, 2.0}) {
    for (const double damping : {0.0, 3.0}) {
      for (const bool torque : {false, true}) {
        for (const bool governor : {false, true}) {
          Scene scene;
          scene.name = "sequences";
          scene.mapping.scale = scale;
          scene.guidance.damping = damping;
          scene.guidance.local_surface = true;
          out.push_back(haptic_settings(scene, omni_capabilities(torque), governor));
        }
      }
    }
  }
  return out;
}

HapticSettings draw_settings(Draw& draw) {
  static const std::vector<HapticSettings> all = all_settings();
  HapticSettings out = all[static_cast<std::size_t>(draw.below(static_cast<int>(all.size())))];
  if (draw.chance(0.5)) out.guide.reach = 0.060;
  if (draw.chance(0.5)) out.guide.smoother_length = 105;
  if (draw.chance(0.5)) out.ladder.fade_loop = 200 * kMillisecond;
  if (draw.chance(0.3)) out.guide.torque_stiffness = draw.between(0.0, 3.0);
  return out;
}

// Hand, clock and orders of a tick.
class Course {
 public:
  explicit Course(Draw& draw)
      : hand_(draw),
        invalid_(draw, 0.001, 0.05),
        clutch_(draw, 0.001, 0.2),
        drop_(draw, 0.001, 0.1),
        late_(draw, 0.0005, 0.0015) {}

  // The time since the last tick [s].
  double next(Draw& draw, const HapticOutput& out, HapticInput& in) {
    double elapsed = kTick;
    if (late_.step(draw, kTick)) elapsed += draw.between(0.001, 0.02);
    in.unseen = static_cast<Nanos>(elapsed * 1e9);
    in.hand = hand_.move(draw, elapsed);
    in.hand.valid = !invalid_.step(draw, elapsed);
    in.hand.clutch_button = clutch_.step(draw, elapsed);
    in.hand.drop_button = drop_.step(draw, elapsed);
    in.order = HapticOrder();
    const SessionState session = out.link.state;
    const bool waits = session == SessionState::kAligning || session == SessionState::kHoming;
    const bool idle = session == SessionState::kOff || session == SessionState::kFault;
    if (!waits && draw.chance(idle ? 0.5 : kTick / kOrderEvery)) {
      in.order = draw_order(draw, session, out.link.X_SU);
    }
    return elapsed;
  }

 private:
  HandCourse hand_;
  Spell invalid_, clutch_, drop_, late_;
};

void note(Worst& worst, const Judged& judged, std::uint64_t seed, int tick) {
  if (judged.ratio > worst.judged.ratio) worst = {judged, seed, tick};
}

void count(const SequenceTick& t, std::uint64_t seed, SequenceFigures& figures) {
  ++figures.ticks;
  if (t.watch.led()) ++figures.led;
  for (std::size_t i = 0; i < kBounds; ++i) {
    note(figures.worst[i], t.watch.judged()[i], seed, t.tick);
    if (breaks(t.watch.judged()[i].ratio)) ++figures.broken[i];
  }
  if (t.in.order.kind == OrderKind::kNone) return;
  if (t.out.order_result != Reason::kNone) {
    ++figures.refused;
  } else if (t.in.order.kind == OrderKind::kTool) {
    ++figures.tools;
  }
}

}  // namespace

bool SequenceFigures::holds() const noexcept {
  for (const std::uint64_t ticks_broken : broken) {
    if (ticks_broken > 0) return false;
  }
  return true;
}

void SequenceFigures::add(const SequenceFigures& later) noexcept {
  for (std::size_t i = 0; i < kBounds; ++i) {
    note(worst[i], later.worst[i].judged, later.worst[i].seed, later.worst[i].tick);
    broken[i] += later.broken[i];
  }
  sequences += later.sequences;
  ticks += later.ticks;
  led += later.led;
  tools += later.tools;
  refused += later.refused;
}

SequenceFigures run_sequence(std::uint64_t seed, const SequenceOptions& options) {
  Draw draw(seed);
  const HapticSettings judged_by = draw_settings(draw);
  HapticSettings settings = judged_by;
  if (options.tamper) options.tamper(settings);
  const auto state = std::make_unique<HapticState>();
  HapticInput in;
  HapticOutput out;
  TipStandIn tip(draw);
  Course course(draw);
  Draw surfaces(seed ^ kSurfaces);
  SurfaceCourse surface(surfaces);
  Watch watch(judged_by);
  SequenceFigures figures;
  figures.sequences = 1;
  double elapsed = kTick;
  for (int i = 0; i < kSequenceTicks; ++i) {
    tip.step(draw, out.link, elapsed, in);
    surface.tell(surfaces, elapsed, out.link.X_SU.p, in.slave);
    elapsed = course.next(draw, out, in);
    const double dt = std::min(elapsed, kLongestStep);
    haptic_step(settings, in, dt, *state, out);
    watch.see(in, dt, *state, out);
    const SequenceTick tick{i, dt, judged_by, in, out, watch};
    count(tick, seed, figures);
    if (options.look) options.look(tick);
  }
  return figures;
}

}  // namespace handrail
