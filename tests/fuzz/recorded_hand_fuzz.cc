// CSV files of recorded hands.
#include <sstream>

#include "devices/hand/recorded_hand_io.h"
#include "tests/fuzz/expect_error.h"

namespace handrail {

HANDRAIL_FUZZ(recorded_hand) {
  std::istringstream in{std::string(fuzz::text_of(bytes))};
  const Result<RecordedMotion> motion = read_recorded_motion(in, "hand.csv");
  if (!motion) return fuzz::require_error_at("hand.csv:", motion.message());
  fuzz::require(motion->rows() >= 2 && motion->duration() > 0.0, "a motion takes time");
  const Vec3 box = motion->half_extent().array() + 1e-9;
  double before = -1.0;
  for (const RecordedSample& sample : motion->samples()) {
    fuzz::require(sample.t - before > 4e-7, "its samples are a microsecond apart");
    before = sample.t;
    const VectorMotion here = motion->motion_at(sample.t);
    const VectorMotion later = motion->motion_at(sample.t + 1e-3);
    fuzz::require(here.p.allFinite() && here.v.allFinite() && later.v.allFinite(),
                  "a hand is somewhere");
    fuzz::require((later.p.cwiseAbs().array() <= box.array()).all(), "and within its box");
  }
}

}  // namespace handrail
