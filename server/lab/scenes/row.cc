#include "server/lab/scenes/row.h"

namespace handrail {
namespace {

bool beats(const AccuracyRow& a, const AccuracyRow& b) {
  const bool as_good = a.error.rms <= b.error.rms && a.cost.median <= b.cost.median;
  return as_good && (a.error.rms < b.error.rms || a.cost.median < b.cost.median);
}

}  // namespace

std::vector<bool> efficient(const AccuracyRows& rows) {
  std::vector<bool> out;
  for (const AccuracyRow& row : rows) {
    out.push_back(std::none_of(rows.begin(), rows.end(), [&](const AccuracyRow& other) {
      return other.choice == row.choice && other.needs == row.needs && beats(other, row);
    }));
  }
  return out;
}

}  // namespace handrail
