#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "server/lab/scenes/contest.h"
#include "server/lab/scenes/explain_price.h"
#include "server/lab/scenes/press_course.h"

namespace handrail {
namespace {

constexpr int kRigTurns = 10, kRigBatches = 3;

// What a rig without effect `i` would run; a thread goes with its socket.
Scene without_rig_effect(const Scene& scene, std::size_t i) {
  Scene out = scene;
  out.simulate = simulated_by(scene);
  auto& effects = out.simulate->effects;
  const bool socket = kind_of(effects[i]) == RigEffectKind::kHexSocket;
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(i));
  if (socket) {
    std::erase_if(effects,
                  [](const RigEffectSpec& e) { return kind_of(e) == RigEffectKind::kScrewThread; });
  }
  return out;
}

}  // namespace

std::vector<RigWithout> rigs_without_each(const Scene& scene) {
  std::vector<RigWithout> out;
  const auto effects = simulated_by(scene).effects;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const RigEffectKind kind = kind_of(effects[i]);
    const auto same =
        std::count_if(effects.begin(), effects.begin() + static_cast<std::ptrdiff_t>(i),
                      [kind](const RigEffectSpec& e) { return kind_of(e) == kind; });
    const std::string name = name_of(kind);
    out.push_back(
        {same > 0 ? fmt::format("{} {}", name, same + 1) : name, without_rig_effect(scene, i)});
  }
  return out;
}

Result<RigPrice> price_of_rig(const Scene& scene, const std::atomic<bool>& cancelled) {
  const Result<PressCourse> course = press_course(scene);
  if (!course) return course.status();
  const std::vector<RigWithout> rigs = rigs_without_each(scene);
  // A batch is once round the course.
  const int calls =
      static_cast<int>(static_cast<Nanos>(course->q.size()) * kMxtPeriod / kMillisecond);
  Contest contest;
  const auto add = [&](const Scene& of) {
    auto run = std::make_shared<PressRun>(of, *course);
    contest.add([] {},
                [run, calls] {
                  for (int i = 0; i < calls; ++i) run->tick();
                  keep(run->rig().true_tip());
                },
                calls);
  };
  add(scene);
  for (const RigWithout& rig : rigs) add(rig.scene);
  contest.run(kRigTurns, kRigBatches, cancelled);
  RigPrice out;
  if (cancelled) return out;
  out.step_ns = contest.time(0).median;
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    out.effects.push_back({rigs[i].left_out, true, std::max(contest.longer(0, i + 1), 0.0)});
  }
  return out;
}

}  // namespace handrail
