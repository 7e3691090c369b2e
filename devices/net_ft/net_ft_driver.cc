#include "devices/net_ft/net_ft_driver.h"

#include <chrono>
#include <thread>

#include "devices/self_test/ft_test.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr Nanos kFirstRecord = 300 * kMillisecond;  // a way of 0.1 s, and some streams begin late
constexpr char kSensorTaken[] =
    "a slave on this computer reads it, and a sensor streams to one reader";
constexpr char kAskTheSlave[] = "handrail doctor; or end the slave first";

}  // namespace

std::string NetFtDriver::block() const {
  const RdtClientOptions& c = options_.client;
  return "force_sensor { address: \"" + options_.address +
         "\" port: " + std::to_string(options_.port) +
         " counts_per_n: " + number_text(c.counts_per_n) +
         " counts_per_n_m: " + number_text(c.counts_per_n_m) +
         " range_n: " + number_text(options_.range_n) + " }";
}

std::vector<Sighting> NetFtDriver::probe() {
  const std::string place = options_.address + ":" + std::to_string(options_.port);
  if (taken_) return {{place, Readiness::kReady, kSensorTaken, kAskTheSlave}};
  NetFtSensor sensor(options_);
  if (const Status started = sensor.start(); !started) {
    return {{place, Readiness::kUnfinished, started.message(),
             "force_sensor { address } in the slave's file"}};
  }
  const Nanos until = monotonic_now() + kFirstRecord;
  while (monotonic_now() < until) {
    FtSample sample;
    if (sensor.poll(monotonic_now(), sample)) {
      if (sample.status == 0) return {{place, Readiness::kReady, "it streams", ""}};
      return {{place, Readiness::kUnfinished, "it streams, and reports a fault",
               "handrail devices test net-ft"}};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {{place, Readiness::kAbsent, "no record came in 0.3 s",
           "is it powered, on this network, and RDT enabled on its page? force_sensor { address } "
           "in the slave's file"}};
}

StartedTest NetFtDriver::test(const TestWishes& wishes) {
  if (taken_)
    return Status::error(std::string("force sensor: ") + kSensorTaken + "; " + kAskTheSlave);
  auto sensor = std::make_unique<NetFtSensor>(options_);
  if (const Status started = sensor->start(); !started) return started;
  return StartedTest(std::make_unique<FtTest>(std::move(sensor), wishes, block()));
}

StartedTest NetFtDriver::calibrate() {
  return Status::error(
      "force sensor: there is nothing to find out here; what hangs on it: handrail calibrate "
      "payload");
}

}  // namespace handrail
