#include "server/lab/study/linear/linear_figure.h"

#include <limits>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr LinearFigureInfo kLinearInfo[kLinearFigures] = {
    {"execution_time_s", "execution time", "s", 1.0, {14.6, 14.8}},
    {"path_mm", "path of the tip", "mm", 1.0 / kMm, {215.3, 166.9}},
    {"max_position_error_mm", "largest position error", "mm", 1.0 / kMm, {7.79, 0.56}},
    {"max_orientation_error_deg", "largest orientation error", "deg", 1.0 / kDeg, {3.77, 0.11}},
    {"max_position_error_on_lines_mm", "  on AB and BC only", "mm", 1.0 / kMm, {}},
    {"max_orientation_error_to_reference_deg", "  to the one commanded", "deg", 1.0 / kDeg, {}},
    {"max_orientation_error_to_nominal_deg", "  to the scene's nominal", "deg", 1.0 / kDeg, {}},
};

}  // namespace

const LinearFigureInfo& info_of(LinearFigure figure) noexcept {
  return kLinearInfo[static_cast<int>(figure)];
}

double TrialResult::*field_of(LinearFigure figure) noexcept {
  switch (figure) {
    case LinearFigure::kTime: break;
    case LinearFigure::kPath: return &TrialResult::path;
    case LinearFigure::kPosition: return &TrialResult::position_error;
    case LinearFigure::kOrientation: return &TrialResult::orientation_error;
    case LinearFigure::kPositionOnLines: return &TrialResult::position_error_on_lines;
    case LinearFigure::kOrientationToReference: return &TrialResult::orientation_error_to_reference;
    case LinearFigure::kOrientationToNominal: return &TrialResult::orientation_error_to_nominal;
  }
  return &TrialResult::execution_time;
}

double value_of(const TrialResult& result, LinearFigure figure) noexcept {
  if (result.end != TrialEnd::kDone) return std::numeric_limits<double>::infinity();
  return result.*field_of(figure);
}

ByPerson values_of(const LinearStudy& study, StudyMode mode, LinearFigure figure) {
  return study.values(mode, [&](const TrialResult& result) { return value_of(result, figure); });
}

}  // namespace handrail
