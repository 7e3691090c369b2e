// What a screw-fastening study says of the dissertation's sizes and of the targets set for it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "server/lab/study/screw/screw_figure.h"

namespace handrail {

// How much lower a median is with tools or protection, beside what the dissertation implies.
struct ScrewEffect {
  ScrewPairing pairing = ScrewPairing::kToolsNC;
  ScrewFigure figure = ScrewFigure::kTime;
  double lowered = 0.0;  // share; below 0: it is higher; NaN: both medians are failed trials
  Interval lowered_95;
  double implied = 0.0;
  // The dissertation's size is within the interval.
  bool reproduced() const {
    return lowered_95.low <= implied && implied <= lowered_95.high && !std::isnan(lowered);
  }
};

// Mean force by protection, path and time by tools. Deterministic for the seed.
std::vector<ScrewEffect> effects_of(const ScrewStudy& study, std::uint64_t seed);
// "mean contact force, with protection, without tools: 53 % lower (95 %: 50 to 56 %; dissertation
// 46.8 % lower), more than there".
std::string text_of(const ScrewEffect& effect);

struct ScrewTarget {
  std::string what;
  std::string found;
  bool met = false;
};
std::vector<ScrewTarget> targets_of(const ScrewStudy& study, std::uint64_t seed);

}  // namespace handrail
