// Where a bumper keeps its promises and where it does not: pushes into surfaces of every stiffness,
// speed, delay and friction.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "server/lab/contact/bumper_bench.h"

namespace handrail {

struct BumperMapOptions {
  BumperSettings::Form form = BumperSettings::Form::kDefault;
  // With 45 ms of servo lag and 20 to 60 N/mm in series: no contact is stiffer. Else the arm is
  // where it is told, and a contact of any stiffness is felt as it is.
  bool rig = false;
  double promise =
      0.0;  // force that no approach may pass, of a bumper that knows the stiffness [N]
  // Of the sensor, standard deviation, known to the bumper, below 10 [N]. A contact begins at five.
  double noise = 0.0;
  int threads = 0;
  const std::atomic<bool>* cancelled = nullptr;
  std::function<void(std::size_t)> progress;
};

// The worst of eight pushes: straight or slanted, hard or gentle, late command or late sensor.
struct BumperCell {
  BumperCase of;       // stiffness, speed, delay, friction, servo lag, noise
  BumperRun worst;     // the largest of each, the least share; `settled` of the largest peak
  double bound = 0.0;  // of the peak: peak_bound, the promise if that is less [N]

  bool goes_in() const noexcept { return worst.inward > 1e-9; }
  bool swings() const noexcept { return worst.swing > 2.0; }
  bool peaks() const noexcept { return worst.peak > bound; }
  bool good() const noexcept { return !goes_in() && !swings() && !peaks() && worst.released; }
};

struct BumperMap {
  BumperMapOptions options;
  std::vector<BumperCell> cells;  // by friction, stiffness, speed, delay
};

// 12 stiffnesses of 1 to 1000 N/mm (6 to 60 with `rig`), 6 speeds of 1 to 250 mm/s, 6 delays of 0
// to 50 ms, friction 0 and 0.3. Independent of threads. Empty when cancelled.
BumperMap run_bumper_map(const BumperMapOptions& options);

// Whether every cell keeps every promise.
bool keeps_all(const BumperMap& map);

// With every cell of every map.
std::string bumper_json(const std::vector<BumperMap>& maps);
// One line for each map and friction.
std::string bumper_table(const std::vector<BumperMap>& maps);

}  // namespace handrail
