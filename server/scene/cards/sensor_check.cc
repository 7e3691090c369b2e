#include "server/scene/cards/sensor_check.h"

#include <arpa/inet.h>

#include <algorithm>
#include <iterator>

#include "server/base/plain_text.h"
#include "server/scene/cards/card_check.h"

namespace handrail {
namespace {

using SensorProblem = std::optional<FieldProblem>;

// What OnRobot's sensors can be told, and others cannot.
SensorProblem check_dialect(const pb::FtConfig& c, const std::string& block) {
  const bool told = c.has_rate_hz() || c.has_sensor_filter_hz();
  if (told && c.dialect() != pb::FtConfig::ONROBOT) {
    return FieldProblem{block + (c.has_rate_hz() ? ".rate_hz" : ".sensor_filter_hz"),
                        "only used with dialect: ONROBOT; others are told on their own page"};
  }
  if (c.has_rate_hz() && 1000 % c.rate_hz() != 0) {
    return FieldProblem{block + ".rate_hz",
                        std::to_string(c.rate_hz()) +
                            " has no period of whole milliseconds, expected 1000, 500, 250, 200, "
                            "125, 100 and so on"};
  }
  // As the sensor has them (devices/net_ft/rdt_packet.h).
  constexpr double kCutoffs[] = {0.0, 500.0, 150.0, 50.0, 15.0, 5.0, 1.5};
  if (!c.has_sensor_filter_hz() || std::find(std::begin(kCutoffs), std::end(kCutoffs),
                                             c.sensor_filter_hz()) != std::end(kCutoffs)) {
    return std::nullopt;
  }
  return FieldProblem{
      block + ".sensor_filter_hz",
      number_text(c.sensor_filter_hz()) + " is none of 0, 500, 150, 50, 15, 5 and 1.5"};
}

bool simulated(const pb::DeviceConfig& device) {
  switch (device.kind()) {
    case pb::DeviceConfig::SIM_OMNI:
    case pb::DeviceConfig::SIM_OMNI_TORQUE:
    case pb::DeviceConfig::SIM_JOYSTICK:
    case pb::DeviceConfig::PAGE: return true;
    default: return false;
  }
}

// Of its own on the handle: nothing there has a usual place or size.
SensorProblem check_given(const pb::FtConfig& c, const std::string& block) {
  if (c.has_filter_ms()) {
    return FieldProblem{block + ".filter_ms",
                        "only used with force_sensor of the slave: nothing is filtered here"};
  }
  if (!c.enabled()) return std::nullopt;
  if (!c.has_range_n()) {
    return FieldProblem{block + ".range_n",
                        "missing, expected the most that the sensor measures per axis, such as "
                        "100 N"};
  }
  if (!c.has_comedi() && !c.has_address()) {
    return FieldProblem{block + ".address",
                        "missing, expected the sensor's IPv4 address such as 192.168.1.1, or "
                        "comedi for one at a card"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<FieldProblem> check_ipv4(const std::string& field, const std::string& address) {
  in_addr parsed{};
  if (::inet_pton(AF_INET, address.c_str(), &parsed) == 1) return std::nullopt;
  return FieldProblem{field, "'" + address + "' is not an IPv4 address such as 127.0.0.1"};
}

std::optional<FieldProblem> check_peer_port(const std::string& field, std::uint32_t port) {
  if (port != 0) return std::nullopt;
  return FieldProblem{field, "0 is no port to send to, expected 1 to 65535"};
}

std::optional<FieldProblem> check_sensor(const pb::FtConfig& config, const std::string& block) {
  if (SensorProblem p = check_comedi_sensor(config, block)) return p;
  if (config.has_comedi()) return std::nullopt;
  if (SensorProblem p = check_ipv4(block + ".address", config.address())) return p;
  if (SensorProblem p = check_peer_port(block + ".port", config.port())) return p;
  return check_dialect(config, block);
}

std::optional<FieldProblem> check_handle_sensor(const pb::MasterConfig& config) {
  if (!config.has_handle_sensor()) return std::nullopt;
  const pb::HandleSensorConfig& c = config.handle_sensor();
  if (c.simulated() == c.has_sensor()) {
    return FieldProblem{"handle_sensor", c.has_sensor()
                                             ? "both simulated and sensor, expected one of them"
                                             : "neither sensor nor simulated, expected one of "
                                               "them"};
  }
  if (c.simulated()) {
    if (simulated(config.device())) return std::nullopt;
    return FieldProblem{"handle_sensor.simulated",
                        "true, but no simulated hand holds this device, expected one of kind "
                        "SIM_OMNI, SIM_OMNI_TORQUE, SIM_JOYSTICK or PAGE"};
  }
  const std::string block = "handle_sensor.sensor";
  if (SensorProblem p = check_given(c.sensor(), block)) return p;
  if (!c.sensor().enabled()) return std::nullopt;
  if (SensorProblem p = check_sensor(c.sensor(), block)) return p;
  const bool joystick = config.device().kind() == pb::DeviceConfig::JOYSTICK;
  const pb::ComediFtConfig& card = c.sensor().comedi();
  // A card of JR3's has no motors to ask; a card with analog inputs may do both.
  if (!joystick || !c.sensor().has_comedi() || card.kind() != pb::ComediFtConfig::JR3 ||
      card.device() != config.device().joystick().device()) {
    return std::nullopt;
  }
  return FieldProblem{
      block + ".comedi.device",
      "'" + shown(card.device()) + "' is taken by device.joystick.device, expected JR3's own card"};
}

}  // namespace handrail
