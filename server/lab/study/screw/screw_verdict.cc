#include "server/lab/study/screw/screw_verdict.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace handrail {
namespace {

constexpr double kNearFit = 0.30;  // [1]: NC-NV medians are this near to what is implied
constexpr double kLeastForce = 0.30, kMostForce = 0.70;  // lowered by protection
constexpr double kHardest = 400.0, kGentlest = 200.0;    // worst trial without and with it [N]
constexpr double kLeastPath = 0.20;                      // lowered by tools
constexpr double kSigns = 0.90;                          // of operators are helped

struct Asked {
  ScrewPairing pairing;
  ScrewFigure figure;
};
constexpr Asked kAsked[] = {{ScrewPairing::kProtectionNV, ScrewFigure::kMeanForce},
                            {ScrewPairing::kProtectionV, ScrewFigure::kMeanForce},
                            {ScrewPairing::kToolsNC, ScrewFigure::kPath},
                            {ScrewPairing::kToolsC, ScrewFigure::kPath},
                            {ScrewPairing::kToolsNC, ScrewFigure::kTime},
                            {ScrewPairing::kToolsC, ScrewFigure::kTime}};

bool by_tools(ScrewPairing pairing) {
  return pairing == ScrewPairing::kToolsNC || pairing == ScrewPairing::kToolsC;
}

// What both modes of a pair have or lack.
const char* besides(ScrewPairing pairing) {
  constexpr const char* kTexts[kScrewPairs] = {"without protection", "with protection",
                                               "without tools", "with tools"};
  return kTexts[static_cast<int>(pairing)];
}

const char* means(ScrewPairing pairing) { return by_tools(pairing) ? "tools" : "protection"; }

// At least one of the medians is not a failed trial: their ratio says something.
bool finite(const ScrewStudy& study, ScrewPairing pairing, ScrewFigure figure) {
  const ScrewPair pair = pair_of(pairing);
  return std::isfinite(median(pooled(values_of(study, pair.with, figure)))) ||
         std::isfinite(median(pooled(values_of(study, pair.without, figure))));
}

constexpr const char* kAllFailed = "most trials failed";

ScrewTarget fitted(const ScrewStudy& study, ScrewFigure figure) {
  const ScrewFigureInfo& info = info_of(figure);
  const double found = median(pooled(values_of(study, ScrewMode::kNCNV, figure))) * info.per_si;
  return {fmt::format("NC-NV: {} within 30 % of {:.4g} {}", info.title, info.implied[0], info.unit),
          fmt::format("{:.3g} {}", found, info.unit),
          std::abs(found / info.implied[0] - 1.0) <= kNearFit};
}

ScrewTarget size(const ScrewEffect& effect) {
  const std::string with =
      fmt::format("with {}, {}", means(effect.pairing), besides(effect.pairing));
  const std::string title = info_of(effect.figure).title;
  const std::string found = std::isnan(effect.lowered)
                                ? kAllFailed
                                : fmt::format("{:.0f} % lower", 100.0 * effect.lowered);
  if (effect.figure == ScrewFigure::kMeanForce) {
    return {fmt::format("{} 30 to 70 % lower {}", title, with), found,
            effect.lowered >= kLeastForce && effect.lowered <= kMostForce};
  }
  if (effect.figure == ScrewFigure::kPath) {
    return {fmt::format("{} at least 20 % shorter {}", title, with), found,
            effect.lowered >= kLeastPath};
  }
  return {fmt::format("{} not longer {}", title, with), found, effect.lowered >= 0.0};
}

ScrewTarget worst(const ScrewStudy& study, bool protection) {
  const double force =
      protection
          ? std::max(worst_force(study, ScrewMode::kCNV), worst_force(study, ScrewMode::kCV))
          : std::max(worst_force(study, ScrewMode::kNCNV), worst_force(study, ScrewMode::kNCV));
  return {protection ? "worst trial under 200 N with protection"
                     : "worst trial over 400 N without protection",
          fmt::format("{:.0f} N", force), protection ? force < kGentlest : force > kHardest};
}

ScrewTarget failures(const ScrewStudy& study, ScrewPairing pairing) {
  const FailureComparison failed = failures_of(study, pairing);
  return {fmt::format("failed trials fewer with {}, {}", means(pairing), besides(pairing)),
          fmt::format("{}, without {}", failed.with, failed.without),
          failed.with < failed.without || failed.with == 0};
}

ScrewTarget sign(const ScrewStudy& study, const Asked& asked, std::uint64_t seed) {
  const double helped = comparison_of(study, asked.pairing, asked.figure, seed).helped;
  return {fmt::format("{} lower for 90 % of operators with {}, {}", info_of(asked.figure).title,
                      means(asked.pairing), besides(asked.pairing)),
          fmt::format("{:.1f} %", 100.0 * helped), helped >= kSigns};
}

ScrewTarget sign_of_failures(const ScrewStudy& study, ScrewPairing pairing) {
  const double share = failures_of(study, pairing).no_more.value;
  return {fmt::format("no more failures for 90 % of operators with {}, {}", means(pairing),
                      besides(pairing)),
          fmt::format("{:.1f} %", 100.0 * share), share >= kSigns};
}

}  // namespace

std::vector<ScrewEffect> effects_of(const ScrewStudy& study, std::uint64_t seed) {
  std::vector<ScrewEffect> out;
  for (const Asked& asked : kAsked) {
    const Paired paired = comparison_of(study, asked.pairing, asked.figure, seed);
    const bool told = finite(study, asked.pairing, asked.figure);
    ScrewEffect& effect = out.emplace_back();
    effect.pairing = asked.pairing;
    effect.figure = asked.figure;
    effect.lowered = told ? 1.0 - paired.ratio : std::numeric_limits<double>::quiet_NaN();
    effect.lowered_95 = {1.0 - paired.ratio_95.high, 1.0 - paired.ratio_95.low};
    effect.implied = 1.0 - implied_ratio(asked.pairing, asked.figure);
  }
  return out;
}

std::string text_of(const ScrewEffect& effect) {
  const std::string what = fmt::format("{}, with {}, {}", info_of(effect.figure).title,
                                       means(effect.pairing), besides(effect.pairing));
  if (std::isnan(effect.lowered)) {
    return fmt::format("{}: cannot be told, {} (dissertation {:.1f} % lower)", what, kAllFailed,
                       100.0 * effect.implied);
  }
  const bool lower = effect.lowered >= 0.0;
  const Interval& in = effect.lowered_95;
  const char* verdict = effect.reproduced()               ? "as there, within the interval"
                        : !lower                          ? "the other way there"
                        : effect.lowered > effect.implied ? "more than there"
                                                          : "less than there";
  return fmt::format("{}: {:.3g} % {} (95 %: {:.3g} to {:.3g} %; dissertation {:.1f} % lower), {}",
                     what, 100.0 * std::abs(effect.lowered), lower ? "lower" : "higher",
                     100.0 * (lower ? in.low : -in.high), 100.0 * (lower ? in.high : -in.low),
                     100.0 * effect.implied, verdict);
}

std::vector<ScrewTarget> targets_of(const ScrewStudy& study, std::uint64_t seed) {
  std::vector<ScrewTarget> out;
  for (int i = 0; i < kImpliedFigures; ++i) {
    out.push_back(fitted(study, static_cast<ScrewFigure>(i)));
  }
  for (const ScrewEffect& effect : effects_of(study, seed)) out.push_back(size(effect));
  out.push_back(worst(study, false));
  out.push_back(worst(study, true));
  for (int i = 0; i < kScrewPairs; ++i) {
    out.push_back(failures(study, static_cast<ScrewPairing>(i)));
  }
  for (const Asked& asked : kAsked) out.push_back(sign(study, asked, seed));
  for (int i = 0; i < kScrewPairs; ++i) {
    out.push_back(sign_of_failures(study, static_cast<ScrewPairing>(i)));
  }
  return out;
}

}  // namespace handrail
