// The measures of the linear-movement study.
#pragma once

#include "server/lab/study/linear/linear_study.h"
#include "server/lab/study/statistics.h"

namespace handrail {

// The four measures of Fig. 3.10 first, in its order; then how they change with their definition.
enum class LinearFigure {
  kTime,
  kPath,
  kPosition,
  kOrientation,
  kPositionOnLines,
  kOrientationToReference,
  kOrientationToNominal,
};
inline constexpr int kPublishedFigures = 4;
inline constexpr int kLinearFigures = 7;

struct LinearFigureInfo {
  const char* name;   // in JSON, with the unit
  const char* title;  // in words
  const char* unit;
  double per_si;                  // value in `unit` of 1 SI
  double published[kStudyModes];  // median of NV and V, dissertation 3.4.1 [unit]; 0: none
};
const LinearFigureInfo& info_of(LinearFigure figure) noexcept;

// Where a trial's result has it [SI].
double TrialResult::*field_of(LinearFigure figure) noexcept;

// The measure of one trial [SI]; infinity for a failed one.
double value_of(const TrialResult& result, LinearFigure figure) noexcept;

// All trials of a mode by operator [SI]; in either mode entry k is the same person.
ByPerson values_of(const LinearStudy& study, StudyMode mode, LinearFigure figure);

}  // namespace handrail
