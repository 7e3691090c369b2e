#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "devices/hand/recorded_hand_io.h"
#include "server/base/units.h"

namespace handrail {
namespace {

struct Row {
  int spacing_us = 0;  // after the row before
  int x_um = 0, y_um = 0, z_um = 0;
};

int int_between(int low, int high) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(low, high + 1));
}

// Rates from 100 kHz to below 2 Hz, now and then a coordinate that does not change.
std::vector<Row> any_rows() {
  std::vector<Row> rows(static_cast<std::size_t>(int_between(2, 40)));
  const int widest = *rc::gen::element(100, 5'000, 100'000, 600'000);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = {int_between(10, widest), int_between(-90'000, 90'000), int_between(-90'000, 90'000),
               int_between(-90'000, 90'000)};
    if (int_between(0, 9) == 0) rows[i].spacing_us = 250'000;
    if (i > 0 && int_between(0, 3) == 0) rows[i].x_um = rows[i - 1].x_um;
  }
  return rows;
}

std::string csv_of(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "t_s,x_mm,y_mm,z_mm\n" << std::fixed << std::setprecision(6);
  double t = 1.0;
  for (const Row& row : rows) {
    t += row.spacing_us * 1e-6;
    out << t << ',' << row.x_um * 1e-3 << ',' << row.y_um * 1e-3 << ',' << row.z_um * 1e-3 << '\n';
  }
  return out.str();
}

RC_GTEST_PROP(RecordedHand, AnyRisingRecordingPlaysFiniteInsideItsBoxAndNoFasterThanThrice, ()) {
  const std::vector<Row> rows = any_rows();
  std::istringstream in(csv_of(rows));
  const auto read = read_recorded_motion(in, "any.csv");
  RC_ASSERT(read.is_ok());
  const RecordedMotion& motion = *read;
  RC_ASSERT(motion.rows() == rows.size());
  const auto& s = motion.samples();
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    const double h = s[i + 1].t - s[i].t;
    const Vec3 mean_speed = ((s[i + 1].p - s[i].p) / h).cwiseAbs();
    const Vec3 low = s[i].p.cwiseMin(s[i + 1].p);
    const Vec3 high = s[i].p.cwiseMax(s[i + 1].p);
    Vec3 last = motion.at(s[i].t);
    for (int k = 1; k <= 32; ++k) {
      const VectorMotion m = motion.motion_at(s[i].t + h * k / 32.0);
      RC_ASSERT(m.p.allFinite() && m.v.allFinite());
      if (k == 32) {
        // The last instant before the next sample, where rounding weighs most.
        const Vec3 p = motion.at(std::nextafter(s[i + 1].t, 0.0));
        RC_ASSERT((p.array() >= low.array()).all() && (p.array() <= high.array()).all());
      } else {
        RC_ASSERT((m.p.array() >= low.array()).all());
        RC_ASSERT((m.p.array() <= high.array()).all());
        RC_ASSERT((m.v.cwiseAbs().array() <= 3.0 * mean_speed.array() + 1e-9).all());
      }
      RC_ASSERT((m.p.cwiseAbs().array() <= motion.half_extent().array() + 1e-12).all());
      RC_ASSERT(
          ((m.p - last).cwiseAbs().array() <= 3.0 * mean_speed.array() * h / 32.0 + 1e-9).all());
      last = m.p;
    }
  }
}

RC_GTEST_PROP(RecordedHand, GapsAreTheSpacingsOver250Milliseconds, ()) {
  const std::vector<Row> rows = any_rows();
  std::istringstream in(csv_of(rows));
  const auto motion = read_recorded_motion(in, "any.csv");
  RC_ASSERT(motion.is_ok());
  const auto gaps = std::count_if(rows.begin() + 1, rows.end(),
                                  [](const Row& row) { return row.spacing_us > 250'000; });
  RC_ASSERT(motion->gaps() == static_cast<std::size_t>(gaps));
}

// Whatever the bytes: an answer or an error naming the file, never a crash.
RC_GTEST_PROP(RecordedHand, AnyBytesGiveAMotionOrAnErrorWithItsLine, ()) {
  std::string text = csv_of(any_rows());
  const int changes = int_between(0, 4);
  for (int i = 0; i < changes; ++i) {
    const auto at = static_cast<std::size_t>(int_between(0, static_cast<int>(text.size()) - 1));
    text[at] = static_cast<char>(int_between(0, 255));
  }
  if (int_between(0, 3) == 0) text.resize(static_cast<std::size_t>(int_between(0, 200)));
  std::istringstream in(text);
  const auto motion = read_recorded_motion(in, "any.csv");
  if (motion.is_ok()) {
    RC_ASSERT(motion->rows() >= 2u);
    RC_ASSERT(motion->at(0.5 * motion->duration()).allFinite());
  } else {
    RC_ASSERT(motion.message().starts_with("any.csv:"));
  }
}

}  // namespace
}  // namespace handrail
