#include "server/lab/scenes/price_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "devices/joystick/joystick_data.h"
#include "server/lab/console/console.h"
#include "server/lab/scenes/effect_price.h"
#include "server/lab/scenes/explain.h"
#include "server/lab/scenes/explain_price.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr double kShare = 0.15;       // of the price that a saving may differ by, and
constexpr double kNanoseconds = 5;    // at least [ns a tick]
constexpr double kPriceWander = 8.0;  // of the hand, through the scene [s]

}  // namespace

double CheckedPrice::tolerance() const noexcept { return std::max(kShare * listed, kNanoseconds); }

bool CheckedPrice::agrees() const noexcept { return std::abs(saved - listed) <= tolerance(); }

std::string price_table(const std::vector<CheckedPrice>& prices) {
  std::string out =
      "  effect                 listed, ns   left out saves, ns   may differ by, ns\n";
  for (const CheckedPrice& p : prices) {
    out += fmt::format("  {:<20}{:13.1f}{:21.1f}{:20.1f}  {}\n", p.name, p.listed, p.saved,
                       p.tolerance(), p.agrees() ? "agrees" : "DIFFERS");
  }
  const auto differ = std::count_if(prices.begin(), prices.end(),
                                    [](const CheckedPrice& p) { return !p.agrees(); });
  out += differ == 0 ? "every price is what leaving its effect out saves\n"
                     : fmt::format("{} of {} prices are not what leaving the effect out saves\n",
                                   differ, prices.size());
  return out;
}

int run_price_command(const PriceCommand& command, const std::atomic<bool>& cancelled) {
  const auto scene = SceneLibrary().load(command.scene);
  if (!scene) return complain(scene.status(), kUsage);
  if (!scene->walls) {
    return complain(Status::error("scene '" + command.scene + "' has no walls"), kUsage);
  }
  const auto listed = explain_scene(*scene, cancelled);
  if (!listed) return complain(listed.status(), kCancelled);
  const StepPrice saved =
      price_effects(*scene, joystick_capabilities(), wander_through(*scene, kPriceWander));
  if (cancelled) return complain(Status::error("cancelled"), kCancelled);
  std::vector<CheckedPrice> prices;
  for (std::size_t i = 0; i < saved.effects.size(); ++i) {
    prices.push_back(
        {listed->effects[i].name, listed->effects[i].ns_per_tick, saved.effects[i].ns});
  }
  std::printf("scene %s: the master's step takes %.0f ns, the simulated joystick's %.0f ns\n%s",
              command.scene.c_str(), saved.step_ns, saved.device_ns, price_table(prices).c_str());
  return std::all_of(prices.begin(), prices.end(), [](const CheckedPrice& p) { return p.agrees(); })
             ? kDone
             : kFailed;
}

}  // namespace handrail
