// A Mitsubishi arm behind a CR-series controller, by real-time external control over UDP.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "devices/melfa/mxt_client.h"
#include "devices/melfa/r3_switches.h"
#include "devices/robot.h"
#include "devices/udp/udp_client.h"

namespace handrail {

struct MelfaOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = kMxtPort;
  std::uint16_t command_port = kMxtPort + 1;  // TCP: the controller's own switches
  std::string program;  // that opens MXT, as the controller calls it; may be empty
  MxtClientOptions client;
};

// Asks the controller's own switches why it does not answer, as silence_of(). Blocks, bounded: some
// four seconds at most.
Obstacle why_silent(const MelfaOptions& options);

// The controller must be running a program that has opened MXT in JOINT mode for this computer's
// address. A session that was lost or ended is opened again by connect().
class MelfaRobot : public Robot {
 public:
  explicit MelfaRobot(const MelfaOptions& options);
  ~MelfaRobot() override;

  const RobotCapabilities& capabilities() const override { return capabilities_; }
  Status connect(Nanos patience, RobotReply& first) override;
  RobotEvent wait(RobotReply& reply) noexcept override;
  void send(const JointVector& q_target) noexcept override;
  void ask() noexcept override;
  void grip(Grip wanted) noexcept override { client_.grip(wanted); }
  void end() noexcept override;

  // Every packet both ways is left there from now on; null: none. In the loop's thread, or before.
  void keep(PacketTap* tap) noexcept {
    socket_.keep(tap, PacketWay::kRobotIn, PacketWay::kRobotOut);
  }
  const MxtCounters& counters() const noexcept { return client_.counters(); }

 private:
  RobotEvent wait_until(RobotReply& reply, Nanos until) noexcept;

  MelfaOptions options_;
  RobotCapabilities capabilities_;
  MxtClient client_;
  UdpClient socket_;
  std::array<std::uint8_t, 256> buffer_{};
};

}  // namespace handrail
