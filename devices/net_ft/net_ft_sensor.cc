#include "devices/net_ft/net_ft_sensor.h"

#include <algorithm>

#include "server/base/clock.h"

namespace handrail {
namespace {

// About 60 records: what a 1 kHz stream brings while a 141 Hz loop looks away, several times over.
constexpr int kReceiveBuffer = 65536;
constexpr int kMaxDrain = 256;

}  // namespace

NetFtSensor::NetFtSensor(const NetFtOptions& options)
    : options_(options),
      capabilities_{options.client.dialect == RdtDialect::kOnRobot ? "OnRobot HEX" : "ATI Net F/T",
                    options.range_n, options.range_n_m},
      client_(options.client) {}

NetFtSensor::~NetFtSensor() { stop(); }

Status NetFtSensor::start() {
  stop();
  wanted_ = options_.waits;
  open_at_ = monotonic_now() + options_.reopen_pause;
  return open();
}

Status NetFtSensor::open() {
  if (Status s = socket_.open(options_.address, options_.port, kReceiveBuffer); !s) {
    return Status::error("force sensor " + s.message());
  }
  started_ = true;
  send_settings();
  socket_.send(client_.start(monotonic_now()));
  return Status::ok();
}

bool NetFtSensor::opened_again(Nanos now) noexcept {
  if (!wanted_ || now < open_at_) return false;
  open_at_ = now + options_.reopen_pause;
  return static_cast<bool>(open());
}

void NetFtSensor::send_settings() noexcept {
  for (int i = 0;; ++i) {
    const auto request = client_.setting(i);
    if (request.empty()) return;
    socket_.send(request);
  }
}

bool NetFtSensor::poll(Nanos now, FtSample& sample) noexcept {
  if (!started_ && !opened_again(now)) return false;
  bool fresh = false;
  std::array<std::uint8_t, 2 * kRdtRecordSize> buffer;
  for (int i = 0; i < kMaxDrain; ++i) {
    const std::optional<std::size_t> size = socket_.receive(buffer);
    if (!size) break;
    if (client_.on_datagram({buffer.data(), *size}, now, sample)) fresh = true;
  }
  if (const auto request = client_.poll(now); !request.empty()) {
    // The client holds one request at a time.
    std::array<std::uint8_t, kRdtRequestSize> again;
    std::copy(request.begin(), request.end(), again.begin());
    send_settings();
    socket_.send(again);
  }
  if (fresh) sample.wrench = at_tip(options_.mount, sample.wrench);
  return fresh;
}

void NetFtSensor::bias() noexcept {
  if (started_) socket_.send(client_.bias());
}

void NetFtSensor::stop() noexcept {
  if (started_) socket_.send(client_.stop());
  started_ = wanted_ = false;
  socket_.close();
}

}  // namespace handrail
