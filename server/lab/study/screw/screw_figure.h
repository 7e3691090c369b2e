// The measures of the screw-fastening study, and what tools and protection do to them.
#pragma once

#include "server/lab/study/screw/screw_study.h"
#include "server/lab/study/statistics.h"

namespace handrail {

// The three of Fig. 3.13 first, which the dissertation says something of; the first four are
// compared between modes.
enum class ScrewFigure { kTime, kPath, kMeanForce, kMaxForce, kImpulse, kContactTime };
inline constexpr int kImpliedFigures = 3;
inline constexpr int kComparedFigures = 4;
inline constexpr int kScrewFigures = 6;

struct ScrewFigureInfo {
  const char* name;   // in JSON, with the unit
  const char* title;  // in words
  const char* unit;
  double per_si;  // value in `unit` of 1 SI
  // Median of each mode that the savings of dissertation 3.4.2 imply [unit]; 0: none.
  double implied[kScrewModes];
};
const ScrewFigureInfo& info_of(ScrewFigure figure) noexcept;

// What was measured in one trial, however it ended [SI].
double& value_in(ScrewResult& result, ScrewFigure figure) noexcept;
double measured_of(const ScrewResult& result, ScrewFigure figure) noexcept;

// What a trial counts as [SI]. A failed one is the worst rank, infinity, in what grows while a
// trial lasts: time, path, impulse and contact time. Its mean and largest force count as they were
// measured, for a failure must not hide how hard it pushed; infinity if nothing was touched.
double value_of(const ScrewResult& result, ScrewFigure figure) noexcept;

// All trials of a mode by operator [SI]; in every mode entry k is the same person.
ByPerson values_of(const ScrewStudy& study, ScrewMode mode, ScrewFigure figure);

// The largest force of any trial of a mode, failed or not [N]; 0 without trials.
double worst_force(const ScrewStudy& study, ScrewMode mode) noexcept;

// Two modes that differ in one thing.
struct ScrewPair {
  ScrewMode without, with;
};
enum class ScrewPairing { kToolsNC, kToolsC, kProtectionNV, kProtectionV };
inline constexpr int kScrewPairs = 4;
constexpr ScrewPair pair_of(ScrewPairing pairing) noexcept {
  constexpr ScrewPair kPairs[kScrewPairs] = {{ScrewMode::kNCNV, ScrewMode::kNCV},
                                             {ScrewMode::kCNV, ScrewMode::kCV},
                                             {ScrewMode::kNCNV, ScrewMode::kCNV},
                                             {ScrewMode::kNCV, ScrewMode::kCV}};
  return kPairs[static_cast<int>(pairing)];
}

// Person by person; deterministic for the seed.
Paired comparison_of(const ScrewStudy& study, ScrewPairing pairing, ScrewFigure figure,
                     std::uint64_t seed);

// With over without, as the dissertation implies it; 0: it does not.
double implied_ratio(ScrewPairing pairing, ScrewFigure figure) noexcept;

struct FailureComparison {
  int without = 0, with = 0;  // failed trials
  Share no_more;              // operators who fail no more often with than without
};
FailureComparison failures_of(const ScrewStudy& study, ScrewPairing pairing);

}  // namespace handrail
