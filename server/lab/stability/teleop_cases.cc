// Round trip, jitter, loss, hand and surface, one with another.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <string>
#include <utility>

#include "server/base/units.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/teleop_cell.h"

namespace handrail {
namespace {

struct Hand {
  const char* name;
  double stiffness;  // [N/m]
};
constexpr std::array kHands = {Hand{"soft", kLightest}, Hand{"middle", 250.0},
                               Hand{"firm", kFirmest}};

struct Ground {
  const char* name;
  double n_mm;  // 0: none
};
constexpr std::array kGrounds = {Ground{"free", 0.0}, Ground{"K1", 1.0}, Ground{"K10", 10.0},
                                 Ground{"K50", 50.0}};

constexpr std::array kTrips = {0.0, 10.0, 50.0, 100.0, 200.0, 500.0, 1000.0};  // [ms]
constexpr double kHoldAge = 20.0;    // of the newest datagram, from which on the arm holds [ms]
constexpr double kLongest = 5000.0;  // [ms]

struct Weather {
  std::string name;
  LinkFaults faults;
  bool later = false;
  // False: the arm holds again and again, and each time the spring's force is taken from the hand.
  // So by rule a hand that it pushes is not still.
  bool calm = true;
};

LinkFaults with_jitter(double ms) {
  LinkFaults out;
  out.jitter = from_seconds(1e-3 * ms);
  return out;
}

LinkFaults with_loss(double share) {
  LinkFaults out;
  out.loss = share;
  return out;
}

// What a link of that round trip may have beside it; a datagram never comes before it was sent.
std::vector<Weather> weathers(double trip_ms) {
  std::vector<Weather> out = {{"clean", {}}};
  for (const double ms : {10.0, 50.0, 100.0}) {
    if (2.0 * ms > trip_ms) continue;
    // Datagrams that overtake each other leave gaps of up to twice the jitter.
    const bool calm = 2.0 * ms <= kHoldAge;
    out.push_back({fmt::format("jitter{:g}", ms), with_jitter(ms), false, calm});
    out.push_back({fmt::format("jitter{:g}-later", ms), with_jitter(ms), true, calm});
  }
  for (const double share : {0.1, 0.3, 0.5}) {
    // Of 100 datagrams 40 must come; of half of them by chance as few do now and then.
    const bool calm = share < 0.5;
    out.push_back({fmt::format("loss{:g}", 100.0 * share), with_loss(share), false, calm});
    if (share > 0.1) out.push_back({out.back().name + "-later", with_loss(share), true, calm});
  }
  LinkFaults bursts = find_network("bursts")->way;
  bursts.jitter = 0;
  out.push_back({"bursts", bursts, false, false});
  return out;
}

class TeleopCases {
 public:
  void put(const TeleopCell& cell, const std::string& name, bool must_hold, CaseSize size) {
    out_.push_back({"teleoperation/" + name, must_hold, true,
                    [cell](std::uint64_t seed) { return run_teleop_cell(cell, seed); }, size});
  }
  std::vector<StabilityCase> take() { return std::move(out_); }

 private:
  std::vector<StabilityCase> out_;
};

// The quick ones: each round trip once, each hand, each ground, a bad network.
bool is_quick(double trip, const std::string& weather, const Hand& hand, const Ground& ground) {
  const std::string name = hand.name;
  if (weather == "clean" && name == "middle") return trip == 0.0 || trip == 100.0 || trip == 1000.0;
  if (weather == "clean") return trip == 200.0 && ground.n_mm == 50.0;
  return trip == 50.0 && name == "middle" && ground.n_mm == 10.0;
}

}  // namespace

std::vector<StabilityCase> teleop_cases() {
  TeleopCases out;
  TeleopCell far;
  far.round_trip = 1e-3 * kLongest;
  for (const bool local : {false, true}) {
    far.local = local;
    out.put(far, fmt::format("five-seconds/{}", local ? "model" : "spring"), true, CaseSize::kFull);
  }
  for (const double trip : kTrips) {
    for (const Weather& weather : weathers(trip)) {
      for (const Hand& hand : kHands) {
        for (const Ground& ground : kGrounds) {
          for (const bool local : {false, true}) {
            if (local && ground.n_mm == 0.0) continue;
            const TeleopCell cell{1e-3 * trip,
                                  weather.faults,
                                  weather.later,
                                  hand.stiffness,
                                  ground.n_mm * kNewtonPerMm,
                                  local};
            const CaseSize size =
                is_quick(trip, weather.name, hand, ground) ? CaseSize::kLarge : CaseSize::kFull;
            out.put(cell,
                    fmt::format("{}/{:g}ms/{}/{}/{}", local ? "model" : "spring", trip,
                                weather.name, hand.name, ground.name),
                    weather.calm || local, size);
          }
        }
      }
    }
  }
  return out.take();
}

}  // namespace handrail
