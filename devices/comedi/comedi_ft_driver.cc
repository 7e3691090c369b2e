#include "devices/comedi/comedi_ft_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/comedi/comedi_sighting.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr Nanos kFirstReading = 300 * kMillisecond;
constexpr Nanos kCardPatience = 25 * kSecond;  // settling takes about 12 s
// A second at the usual rate: whole periods of the mains; our choice.
constexpr int kBiasReadings = 1000;
constexpr double kMostBiasWay = 0.05;  // from least to most while it is left alone [V]

std::string six_text(const FtSix& values) {
  std::string out;
  for (const double v : values) out += (out.empty() ? "[" : ", ") + number_text(v);
  return out + "]";
}

std::string analog_block(const ComediFtOptions& o) {
  const ComediFtOptions usual;
  std::string out = "kind: ANALOG ";
  if (o.channels != usual.channels) {
    out += "channel: [";
    for (std::size_t i = 0; i < 6; ++i) {
      out += (i == 0 ? "" : ", ") + std::to_string(o.channels[i]);
    }
    out += "] ";
  }
  if (o.range != usual.range) out += "input_range: " + std::to_string(o.range) + " ";
  if (o.reference != usual.reference) {
    out += std::string("reference: ") + (o.reference == 0 ? "GROUND " : "COMMON ");
  }
  out += "matrix: [";
  for (int i = 0; i < 36; ++i) out += (i == 0 ? "" : ", ") + number_text(o.matrix(i / 6, i % 6));
  out += "] ";
  if (!o.bias.isZero(0.0)) out += "bias_v: " + six_text(o.bias) + " ";
  return out;
}

std::string comedi_ft_block(const ComediFtOptions& o, const FtRole& role) {
  const ComediFtOptions usual;
  std::string inner = comedi_place_block(o.place);
  if (o.subdevice) inner += "subdevice: " + std::to_string(*o.subdevice) + " ";
  if (o.rate != usual.rate) inner += "rate_hz: " + number_text(o.rate) + " ";
  if (o.filter != usual.filter) inner += "filter: " + std::to_string(o.filter) + " ";
  if (o.kind == ComediFtKind::kAnalog) inner += analog_block(o);
  return role.open + "comedi { " + inner + "} " + mount_block(o.mount) +
         "range_n: " + number_text(o.range_n) + role.close;
}

bool comes(const FtSample& sample) { return (sample.status & (kFtSettling | kFtLost)) == 0; }

}  // namespace

std::vector<Sighting> ComediFtDriver::probe() {
  const ComediPlace& place = options_.place;
  ComediFtSensor sensor(options_);
  if (const Status started = sensor.start(); !started) {
    return comedi_sightings(place, started.message());
  }
  const Nanos until = monotonic_now() + kFirstReading;
  while (monotonic_now() < until) {
    FtSample sample;
    if (sensor.poll(monotonic_now(), sample) && comes(sample)) {
      return {comedi_library_there(place), {place.device, Readiness::kReady, sensor.text(), ""}};
    }
    sleep_until(monotonic_now() + kMillisecond);
  }
  return {comedi_library_there(place),
          {place.device, Readiness::kUnfinished,
           sensor.text() + "; it gives no readings yet: a sensor takes 12 s to settle",
           role_.test("comedi-ft")}};
}

StartedTest ComediFtDriver::test(const TestWishes& wishes) {
  auto sensor = std::make_unique<ComediFtSensor>(options_);
  if (const Status started = sensor->start(); !started) return started;
  return StartedTest(
      std::make_unique<ComediFtTrial>(std::move(sensor), wishes, comedi_ft_block(options_, role_)));
}

StartedTest ComediFtDriver::calibrate() {
  ComediFtOptions plain = options_;
  plain.mount = FtMount();
  plain.bias.setZero();
  plain.matrix.setIdentity();  // its readings are volts
  auto sensor = std::make_unique<ComediFtSensor>(plain);
  if (const Status started = sensor->start(); !started) return started;
  return StartedTest(std::make_unique<ComediFtCalibration>(std::move(sensor), options_, role_));
}

ComediFtTrial::ComediFtTrial(std::unique_ptr<ComediFtSensor> sensor, const TestWishes& wishes,
                             std::string block)
    : own_(std::move(sensor)), sensor_(own_.get()), wishes_(wishes), block_(std::move(block)) {}

bool ComediFtTrial::turn(Nanos now) {
  if (test_ != nullptr) return test_->turn(now);
  if (!std::exchange(started_, true)) began_ = now;
  FtSample sample;
  if (own_->poll(now, sample) && comes(sample)) {
    test_ = std::make_unique<FtTest>(std::move(own_), wishes_, block_);
    return true;
  }
  gave_up_ = now - began_ >= kCardPatience;
  return !gave_up_;
}

std::string ComediFtTrial::asks() const {
  if (test_ != nullptr) return test_->asks();
  return "leave it alone: a sensor takes 12 s to settle";
}

std::vector<TestItem> ComediFtTrial::items() const {
  std::vector<TestItem> out;
  if (test_ == nullptr) {
    out.push_back({"card", gave_up_ ? Verdict::kBad : Verdict::kNotSeen, sensor_->text(),
                   "is the sensor plugged in? sudo dmesg | grep comedi"});
    return out;
  }
  out.push_back({"card", Verdict::kOk, sensor_->text(), ""});
  const std::vector<TestItem> more = test_->items();
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

bool ComediFtCalibration::enough() const {
  if (options_.kind == ComediFtKind::kJr3) return sensor_->full_scale().first > 0.0;
  return count_ >= kBiasReadings;
}

bool ComediFtCalibration::turn(Nanos now) {
  if (!std::exchange(started_, true)) began_ = now;
  FtSample sample;
  if (sensor_->poll(now, sample) && comes(sample)) {
    FtSix volts;
    volts << sample.wrench.force, sample.wrench.torque;
    least_ = count_ == 0 ? volts : least_.cwiseMin(volts).eval();
    most_ = count_ == 0 ? volts : most_.cwiseMax(volts).eval();
    sum_ += volts;
    ++count_;
  }
  gave_up_ = !enough() && now - began_ >= kCardPatience;
  return !enough() && !gave_up_;
}

std::string ComediFtCalibration::asks() const {
  return options_.kind == ComediFtKind::kJr3
             ? "wait: a sensor takes 12 s to settle"
             : "leave it alone, without a tool and clear of everything";
}

std::vector<TestItem> ComediFtCalibration::items() const {
  if (!enough()) {
    return {{"card", gave_up_ ? Verdict::kBad : Verdict::kNotSeen, sensor_->text(),
             "is the sensor plugged in? sudo dmesg | grep comedi"}};
  }
  if (options_.kind == ComediFtKind::kJr3) {
    return {{"scale", Verdict::kOk, sensor_->text(), "put the block into the file"}};
  }
  const double way = (most_ - least_).maxCoeff();
  const FtSix bias = sum_ / count_;
  return {{"bias", way <= kMostBiasWay ? Verdict::kOk : Verdict::kBad,
           "mean of " + std::to_string(count_) + " readings: " + six_text(bias) +
               " V, which went up and down by " + number_text(std::round(way * 1e4) / 1e4) + " V",
           way <= kMostBiasWay ? "put the block into the file"
                               : "leave it alone; noise: shielding, and what the reference is"}};
}

std::string ComediFtCalibration::block() const {
  ComediFtOptions found = options_;
  if (enough() && options_.kind == ComediFtKind::kJr3) {
    found.range_n = sensor_->full_scale().first;
  } else if (enough()) {
    for (int i = 0; i < 6; ++i) found.bias[i] = std::round(1e5 * sum_[i] / count_) * 1e-5;
  }
  return comedi_ft_block(found, role_);
}

}  // namespace handrail
