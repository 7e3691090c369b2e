// What can be driven over which link: delay, jitter and loss, the same both ways.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/base/time.h"

namespace handrail {

struct LinkCase {
  double delay_ms = 0.0;   // one way
  double jitter_ms = 0.0;  // uniform within +-, at most the delay
  double loss = 0.0;       // 0 to 1, each datagram by itself
  bool in_order = false;   // a queue keeps the order; else each datagram takes its own way
  std::uint64_t seed = 1;  // of network, hand and rig
};

// What one run measured.
struct LinkFigures {
  bool engaged = false;  // within ten seconds of trying once a millisecond
  double after = 0.0;    // from the start of both programs to both engaged [s]
  // Of a simulated hand's motion, three sines of up to 18 mm and a turn, 0.3 to 0.9 Hz:
  double holds = 0.0;    // times the arm stood for the link's sake, a minute
  double held = 0.0;     // share of the time, 0 to 1
  double longest = 0.0;  // such a time [ms]
  double ends = 0.0;     // engagements that ended, a minute; an operator engages again
  double behind = 0.0;   // tip from where the hand asks it to be, root of the mean square [mm]
  // Of strokes over 200 mm, faster than the arm: the tip's mean speed, but for 2 % of each at its
  // ends [mm/s]; 0: it made none.
  double speed = 0.0;
  std::uint64_t violations = 0;  // found by the fault matrix's auditor
};

// `drive`: how long the hand moves. Same input, same figures.
LinkFigures measure_link(const LinkCase& link, Nanos drive);

struct LinkMapOptions {
  std::vector<double> delays_ms = {0, 50, 200, 500};
  std::vector<double> jitters_ms = {0, 20, 50, 100};
  std::vector<double> losses = {0, 0.1, 0.2, 0.4};
  bool in_order = false;
  int seeds = 1;  // of each case, from 1 on
  Nanos drive = 60 * kSecond;
  int threads = 0;  // 0: one a core
  const std::atomic<bool>* cancelled = nullptr;
  std::function<void(std::size_t done, std::size_t of)> progress = {};
};

// Delays, then jitters up to each, then losses; of the first seed.
std::vector<LinkCase> link_cases(const LinkMapOptions& options);

// A case over its seeds. `engaged` if any of them did; `after`, `longest` and `violations` are the
// worst, the rest means, of those that engaged.
struct LinkCell {
  LinkCase link;
  LinkFigures figures;
  int runs = 0;
  int runs_engaged = 0;
};

// In the order of link_cases(). Empty when cancelled.
std::vector<LinkCell> run_link_map(const LinkMapOptions& options);

// One row a delay and jitter, one column a loss. Speeds are shares of the first cell's that
// engaged, which is the best where the lists begin at nothing.
std::string link_table(const LinkMapOptions& options, const std::vector<LinkCell>& cells);
std::string link_json(const std::vector<LinkCell>& cells);

}  // namespace handrail
