#include "tests/storm/sequence.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "server/base/random.h"

namespace handrail::storm {
namespace {

constexpr Nanos kShortestPause = 5 * kMillisecond, kLongestPause = 5 * kSecond;
constexpr Nanos kShortestSilence = 30 * kMillisecond, kLongestSilence = 1600 * kMillisecond;
// All that lasts longer than this together, so that a sequence takes under ten seconds.
constexpr Nanos kBudget = 5 * kSecond;

// Between the two, every factor of ten as often.
Nanos log_uniform(Random& random, Nanos low, Nanos high) {
  const double ratio = static_cast<double>(high) / static_cast<double>(low);
  return static_cast<Nanos>(static_cast<double>(low) * std::pow(ratio, random.uniform()));
}

Nanos uniform(Random& random, Nanos low, Nanos high) {
  return low + static_cast<Nanos>(random.uniform() * static_cast<double>(high - low));
}

Act draw_act(Random& random, Nanos budget) {
  Act act;
  act.after = uniform(random, 0, 700 * kMillisecond);
  act.who = static_cast<Who>(3.0 * random.uniform());
  const double kind = random.uniform();
  if (kind < 0.45) {
    act.what = What::kPause;
    if (random.uniform() < 0.15) act.who = Who::kComputer;
    act.lasts = log_uniform(random, kShortestPause, std::min(kLongestPause, budget));
  } else if (kind < 0.6) {
    act.what = What::kUnplug;
    act.who = Who::kRig;
    act.lasts = log_uniform(random, kShortestSilence, std::min(kLongestSilence, budget));
  } else if (kind < 0.85) {
    act.what = random.uniform() < 0.5 ? What::kKill : What::kTerm;
    act.lasts = uniform(random, 0, std::min(kSecond, budget));
  } else {
    act.what = What::kStop;
    act.who = Who::kMaster;
  }
  act.recover = random.uniform() < 0.5;
  return act;
}

}  // namespace

const char* name(Who who) {
  switch (who) {
    case Who::kRig: return "rig";
    case Who::kSlave: return "slave";
    case Who::kMaster: return "master";
    case Who::kComputer: return "master and slave";
  }
  return "?";
}

Sequence draw(std::uint64_t seed) {
  Random random(seed);
  Sequence out;
  out.seed = seed;
  if (random.uniform() < 0.5) out.loss = 0.01 + 0.04 * random.uniform();
  if (random.uniform() < 0.3) out.time_out_cycles = 60;  // 0.43 s
  const int acts = 1 + static_cast<int>(3.0 * random.uniform());
  Nanos budget = kBudget;
  for (int i = 0; i < acts && budget > 100 * kMillisecond; ++i) {
    out.acts.push_back(draw_act(random, budget));
    budget -= out.acts.back().lasts;
  }
  return out;
}

std::string text(const Act& act) {
  const std::string when = fmt::format("after {:.3f} s ", to_seconds(act.after));
  const auto lasts = fmt::format("{:.1f} ms", 1e3 * to_seconds(act.lasts));
  const std::string then = act.recover ? ", recover" : "";
  switch (act.what) {
    case What::kPause: return when + "pause " + name(act.who) + " " + lasts + then;
    case What::kUnplug: return when + "unplug the rig " + lasts + then;
    case What::kKill:
      return when + "kill " + name(act.who) + ", new start " + lasts + " later" + then;
    case What::kTerm:
      return when + "terminate " + name(act.who) + ", new start " + lasts + " later" + then;
    case What::kStop: return when + "stop" + then;
  }
  return "?";
}

std::string text(const Sequence& sequence) {
  std::string out = fmt::format("loss {:.1f} %", 100.0 * sequence.loss);
  if (sequence.time_out_cycles >= 0) {
    out += fmt::format(", time-out {} cycles", sequence.time_out_cycles);
  }
  for (const Act& act : sequence.acts) out += "; " + text(act);
  return out;
}

}  // namespace handrail::storm
