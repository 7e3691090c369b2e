#include <cmath>
#include <string>

#include "devices/comedi/analog_source.h"
#include "devices/comedi/comedi_ft_sensor.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/plain_text.h"
#include "tests/kernel/trial.h"
#include "tests/kernel/wave.h"

namespace handrail::kernel {
namespace {

ComediFtOptions wave_options() {
  ComediFtOptions out;
  out.kind = ComediFtKind::kAnalog;
  out.matrix = 10.0 * FtMatrix::Identity();  // 10 N/V
  return out;
}

constexpr double kApart = 83.0;  // of 1000 us, half of them, a sixth: what the driver makes of it

struct WaveCount {
  std::uint64_t readings = 0, scans = 0, wrong = 0, silences = 0;
  double flat = 0.0;  // furthest from none, of the inputs without a wave [V]
};

bool watch_one(AnalogSource& source, WaveWatch& watch, WaveCount& count) {
  FtReading reading;
  std::uint32_t scans = 0;
  const FtTaken taken = source.take(reading, scans);
  if (taken == FtTaken::kLost) return false;
  if (taken != FtTaken::kReading) {
    ++count.silences;
    return true;
  }
  const FtSix& v = source.volts();
  if (!watch.next(v[0], v[1], 1000.0 * scans, kApart)) ++count.wrong;
  ++count.readings;
  count.scans += scans;
  count.flat = std::max(count.flat, v.tail<4>().cwiseAbs().maxCoeff());
  return true;
}

}  // namespace

bool try_wave(double seconds) {
  const auto api = load_comedi(kComediLibrary);
  if (!api) return said(false, api.message());
  AnalogSource source(wave_options());
  if (const Status s = source.open(*api); !s) return said(false, s.message());
  bool good = said(true, source.text());
  WaveWatch watch;
  WaveCount count;
  const Nanos began = monotonic_now();
  bool there = true;
  while (there && to_seconds(monotonic_now() - began) < seconds) {
    there = watch_one(source, watch, count);
  }
  const double took = to_seconds(monotonic_now() - began);
  const double rate = static_cast<double>(count.scans) / took;
  good &= said(there && source.overruns() == 0,
               std::to_string(source.overruns()) + " overruns in " + number_text(took) + " s");
  good &= said(count.wrong == 0 && count.readings > 0,
               std::to_string(count.wrong) + " of " + std::to_string(count.readings) +
                   " readings off the closed form; " + std::to_string(count.scans) + " scans");
  // What was lost shows in the phase; this is that the rate is the one asked for.
  good &= said(std::abs(rate - 1000.0) < 10.0, number_text(rate) + " scans/s, 1000 asked for");
  good &= said(count.flat < 3e-4,
               "inputs without a wave are within " + number_text(count.flat) + " V of none");
  return good;
}

bool try_sensor() {
  ComediFtSensor sensor(wave_options());
  if (const Status s = sensor.start(); !s) return said(false, s.message());
  std::uint64_t records = 0, faults = 0;
  double most = 0.0;
  std::uint32_t first = 0, last = 0;
  Nanos first_at = 0, last_at = 0;
  const Nanos began = monotonic_now();
  while (monotonic_now() - began < 2 * kSecond) {
    FtSample sample;
    if (sensor.poll(monotonic_now(), sample)) {
      ++records;
      faults += sample.status != 0 ? 1 : 0;
      last = sample.sequence;
      last_at = monotonic_now();
      if (records == 1) {
        first = last;
        first_at = last_at;
      }
      most = std::max(most, std::abs(sample.wrench.force.x()));
    }
    sleep_until(monotonic_now() + kMillisecond);
  }
  bool good = said(records > 100 && faults == 0, std::to_string(records) + " records, " +
                                                     std::to_string(faults) + " with a fault");
  const double rate = (last - first) / to_seconds(std::max<Nanos>(1, last_at - first_at));
  good &= said(std::abs(rate - 1000.0) < 30.0,
               "its counter went on by " + number_text(std::round(rate)) + " a second");
  good &= said(most > 9.5 && most < 10.1,
               "a wave of 1 V at 10 N/V came to " + number_text(most) + " N");
  sensor.stop();
  return good;
}

}  // namespace handrail::kernel
