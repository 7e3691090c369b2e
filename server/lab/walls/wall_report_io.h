// What hands on the joystick did, as JSON (proto/wall_study.proto), as tables and as traces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/lab/walls/gearshift_run.h"
#include "server/lab/walls/wrench_run.h"

namespace handrail {

// How a study was made.
struct WallHeader {
  std::string scene;
  std::uint32_t seed = 1;
  std::string walls;    // how they are felt; empty: exactly, as drawn
  std::string hand;     // file of a recorded hand; empty: simulated ones
  double c = 0.0;       // wrench [N s/(m rad)]
  int turns = 0;        // wrench, tightening
  int loosen = 0;       // wrench
  double radius = 0.0;  // wrench [m]
};

// A score of Fig. 2.11 and what was measured of each operator in its place.
struct WallAnalogue {
  const char* score;
  const char* measured;
  const char* unit;
  double published_mean, published_median;
  std::vector<double> values;
};
// Of the tightening turns; at least one operator.
std::vector<WallAnalogue> analogues_of(const std::vector<WrenchResult>& people, int turns);
std::vector<WallAnalogue> analogues_of(const std::vector<GearshiftResult>& people);

std::string wrench_json(const WallHeader& header, const std::vector<WrenchResult>& people);
std::string wrench_table(const WallHeader& header, const std::vector<WrenchResult>& people);
std::string gearshift_json(const WallHeader& header, const std::vector<GearshiftResult>& people);
std::string gearshift_table(const WallHeader& header, const std::vector<GearshiftResult>& people);

// One line a tick: CSV with a head that names columns and units.
std::string trace_csv(const std::vector<WallTick>& trace);

}  // namespace handrail
