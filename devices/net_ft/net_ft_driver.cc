#include "devices/net_ft/net_ft_driver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "devices/net_ft/net_ft_page.h"
#include "devices/net_ft/net_ft_page_socket.h"
#include "devices/self_test/finished_test.h"
#include "devices/self_test/ft_test.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr Nanos kFirstRecord = 300 * kMillisecond;  // a way of 0.1 s, and some streams begin late
constexpr Nanos kPagePatience = kSecond;            // its web server is slow
// Of the smaller of two scales: what rounding on a page explains.
constexpr double kSameScale = 1e-6;

std::string sensor_block(const NetFtOptions& options, const FtRole& role) {
  const RdtClientOptions& c = options.client;
  std::string out = role.open + "address: \"" + options.address +
                    "\" port: " + std::to_string(options.port) +
                    " counts_per_n: " + number_text(c.counts_per_n) +
                    " counts_per_n_m: " + number_text(c.counts_per_n_m) +
                    " range_n: " + number_text(options.range_n);
  if (c.dialect == RdtDialect::kOnRobot) out += " dialect: ONROBOT";
  if (c.period_ms) out += " rate_hz: " + std::to_string(1000 / *c.period_ms);
  if (c.filter) out += " sensor_filter_hz: " + number_text(kRdtFilters[*c.filter]);
  const std::string mount = mount_block(options.mount);
  return out + (mount.empty() ? " " : " " + mount) + role.close.substr(1);
}

bool same_scale(double a, double b) { return std::abs(a - b) <= kSameScale * std::min(a, b); }

// What a page says, beside what is configured.
std::vector<TestItem> items_of(const NetFtPage& page, const RdtClientOptions& configured,
                               const FtRole& role) {
  const bool same = same_scale(page.counts_per_n, configured.counts_per_n) &&
                    same_scale(page.counts_per_n_m, configured.counts_per_n_m);
  std::vector<TestItem> out;
  out.push_back({"scale", Verdict::kOk,
                 number_text(page.counts_per_n) + " counts/N and " +
                     number_text(page.counts_per_n_m) + " counts/(N m), from its units " +
                     page.units + (same ? ", as configured" : "; configured is another"),
                 same ? "" : "put the block into the file"});
  out.push_back({"stream", page.streams ? Verdict::kOk : Verdict::kBad,
                 page.streams ? "RDT is enabled" +
                                    (page.rate_hz > 0 ? ", " + std::to_string(page.rate_hz) + " Hz"
                                                      : std::string())
                              : "RDT is disabled",
                 page.streams ? "" : "enable RDT on the sensor's page Communications"});
  out.push_back({"health", page.status == 0 ? Verdict::kOk : Verdict::kBad,
                 page.status == 0 ? "it reports no fault" : "it reports a fault",
                 page.status == 0 ? "" : role.test("net-ft")});
  return out;
}

}  // namespace

std::string NetFtDriver::taken_text() const {
  return "another program of this computer reads it, a " + role_.side +
         " most likely, and it streams to one reader";
}
std::string NetFtDriver::taken_next() const {
  return "handrail doctor; or end the " + role_.side + " first";
}

Status NetFtDriver::none_configured() const {
  return Status::error("force sensor: none is configured; " + role_.place());
}

// Why there is no record.
Sighting NetFtDriver::look_at_page(const std::string& place) const {
  Sighting silent = {place, Readiness::kAbsent, "no record came in 0.3 s",
                     "is it powered and on this network? " + role_.place()};
  if (options_.client.dialect != RdtDialect::kAti) return silent;
  const auto xml = fetch_net_ft_page(options_.address, options_.page_port, kFirstRecord);
  if (!xml) return silent;
  const auto page = parse_net_ft_page(*xml);
  if (!page)
    return {place, Readiness::kUnfinished, silent.fact + "; " + page.message(), silent.next};
  if (!page->streams) {
    return {place, Readiness::kUnfinished, silent.fact + ": RDT is disabled on its page",
            "enable RDT on the sensor's page Communications"};
  }
  return {place, Readiness::kUnfinished, silent.fact + ", though its page says that RDT is enabled",
          "does a firewall keep UDP from this computer, or does another program read the sensor?"};
}

std::vector<Sighting> NetFtDriver::probe() {
  if (options_.address.empty())
    return {{"", Readiness::kAbsent, "none is configured", role_.place()}};
  const std::string place = options_.address + ":" + std::to_string(options_.port);
  if (taken_) return {{place, Readiness::kReady, taken_text(), taken_next()}};
  NetFtSensor sensor(options_);
  if (const Status started = sensor.start(); !started) {
    return {{place, Readiness::kUnfinished, started.message(), role_.place()}};
  }
  const Nanos until = monotonic_now() + kFirstRecord;
  while (monotonic_now() < until) {
    FtSample sample;
    if (sensor.poll(monotonic_now(), sample)) {
      if (sample.status == 0) return {{place, Readiness::kReady, "it streams", ""}};
      return {
          {place, Readiness::kUnfinished, "it streams, and reports a fault", role_.test("net-ft")}};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {look_at_page(place)};
}

StartedTest NetFtDriver::test(const TestWishes& wishes) {
  if (options_.address.empty()) return none_configured();
  if (taken_) return Status::error("force sensor: " + taken_text() + "; " + taken_next());
  auto sensor = std::make_unique<NetFtSensor>(options_);
  if (const Status started = sensor->start(); !started) return started;
  return StartedTest(
      std::make_unique<FtTest>(std::move(sensor), wishes, sensor_block(options_, role_)));
}

StartedTest NetFtDriver::calibrate() {
  if (options_.address.empty()) return none_configured();
  if (options_.client.dialect != RdtDialect::kAti) {
    return Status::error(
        "force sensor: one of OnRobot has no page with its scale; what was not set anew is 10000 "
        "counts/N and 100000 counts/(N m), and what hangs on it: handrail calibrate payload");
  }
  const auto xml = fetch_net_ft_page(options_.address, options_.page_port, kPagePatience);
  if (!xml) {
    return Status::error("force sensor: " + xml.message() +
                         "; is it one of ATI, powered and on this network?");
  }
  const auto page = parse_net_ft_page(*xml);
  if (!page) return Status::error("force sensor: " + page.message());
  NetFtOptions found = options_;
  found.client.counts_per_n = page->counts_per_n;
  found.client.counts_per_n_m = page->counts_per_n_m;
  return StartedTest(std::make_unique<FinishedTest>(items_of(*page, options_.client, role_),
                                                    sensor_block(found, role_)));
}

}  // namespace handrail
