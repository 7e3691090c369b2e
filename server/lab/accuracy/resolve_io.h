// The cheapest setting of a scene that meets a wish, and a copy of the scene with it.
#pragma once

#include <atomic>
#include <string>

#include "server/base/status.h"
#include "server/lab/scenes/row.h"
#include "server/model/scene.h"

namespace handrail {

// Exactly one of the two.
struct AccuracyWish {
  double most_error = 0.0;  // worst error [um]; 0: not asked
  double most_cost = 0.0;   // median of an update [ns]; 0: not asked
};

// From "0.01mm", "10um" or "500ns", "0.5us"; a unit is needed. The error says what was expected.
Result<AccuracyWish> accuracy_wish(const std::string& accuracy, const std::string& budget);

// The row to choose: of those whose worst whole error is small enough the one of least median cost,
// or of those cheap enough the one of least RMS whole error, then of least cost; -1: none meets the
// wish.
int choose(const AccuracyRows& rows, const AccuracyWish& wish);

struct Resolved {
  AccuracyRows rows;  // what there was to choose from, measured
  int chosen = -1;
  std::string why;  // one sentence
};

// Measures what `scene` can choose between: with a painted map, at its own pixel, method and search
// radius; with drawn walls the exact method alone; without walls how the proxy on tools is found.
// Then writes the copy, named after the file, whose image is found from where it stands. Nothing is
// written when no setting meets the wish: the error says the best there is. A file that is there
// already is an error and stays as it is.
Result<Resolved> resolve_scene(const std::string& scene_file, const AccuracyWish& wish,
                               const std::string& out, const std::atomic<bool>& cancelled);

}  // namespace handrail
