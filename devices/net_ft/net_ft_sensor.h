// A force/torque sensor that speaks RDT over UDP: of ATI, or of OnRobot.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "devices/ft_mount.h"
#include "devices/ft_sensor.h"
#include "devices/net_ft/rdt_client.h"
#include "devices/udp/udp_client.h"

namespace handrail {

struct NetFtOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = kRdtPort;
  std::uint16_t page_port = 80;  // of a sensor of ATI; HTTP
  double range_n = 1000.0;       // |force| per axis the sensor can measure [N]
  double range_n_m = 100.0;      // |torque| per axis [N m]
  RdtClientOptions client;
  FtMount mount;
  // Where start() fails, poll() opens its address again and again; it is then not real-time safe
  // until it has.
  bool waits = false;
  Nanos reopen_pause = 100 * kMillisecond;  // as of every device that is looked for
};

class NetFtSensor : public FtSensor {
 public:
  explicit NetFtSensor(const NetFtOptions& options);
  ~NetFtSensor() override;

  const FtCapabilities& capabilities() const override { return capabilities_; }
  Status start() override;
  bool poll(Nanos now, FtSample& sample) noexcept override;
  void bias() noexcept override;
  void stop() noexcept override;

  // Every record and every request is left there from now on; null: none. In the thread that polls,
  // or before.
  void keep(PacketTap* tap) noexcept {
    socket_.keep(tap, PacketWay::kSensorIn, PacketWay::kSensorOut);
  }
  const RdtCounters& counters() const noexcept { return client_.counters(); }

 private:
  Status open();
  bool opened_again(Nanos now) noexcept;
  void send_settings() noexcept;

  NetFtOptions options_;
  FtCapabilities capabilities_;
  RdtClient client_;
  UdpClient socket_;
  bool started_ = false;
  bool wanted_ = false;  // and to be opened again
  Nanos open_at_ = -kForever;
};

}  // namespace handrail
