// A simulated force sensor between a simulated device's handle and the simulated hand.
#pragma once

#include "devices/ft_sensor.h"
#include "server/base/mailbox.h"

namespace handrail {

// Tells what the simulated hand pushes with, which friction and mass of the simulated device keep
// from being what the device is told. A point's force: no torque, no noise, no mount. Simulated.
class SimHandleSensor final : public FtSensor {
 public:
  const FtCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return Status::ok(); }
  bool poll(Nanos, FtSample& sample) noexcept override { return samples_.take(sample); }
  // The model has no zero to take.
  void bias() noexcept override {}
  void stop() noexcept override {}

  // From the thread of the device, once a reading: the hand's force on the handle, in the handle's
  // axes [N]. Not finite: a fault, as a sensor would say. Real-time safe.
  void feel(const Vec3& push_H) noexcept {
    FtSample out;
    out.sequence = ++sequence_;
    out.status = push_H.allFinite() ? 0 : 1;
    if (out.status == 0) out.wrench.force = push_H;
    samples_.publish(out);
  }

 private:
  // Beyond what any hand pushes with.
  FtCapabilities capabilities_{"simulated handle sensor", 1e4, 1e3};
  Mailbox<FtSample> samples_;
  std::uint32_t sequence_ = 0;
};

}  // namespace handrail
