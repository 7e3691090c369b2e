// The sensor on the handle in the master's file: what is wrong is named with place and value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/config_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::string handle_error(const std::string& block, const std::string& more = "") {
  const TempFolder folder;
  const std::string file = folder.write("c.conf", more + "\nhandle_sensor {\n" + block + "\n}\n");
  const std::string error = load_master_config(file).message();
  return error.starts_with(folder.path()) ? error.substr(folder.path().size() + 1) : error;
}

TEST(HandleConfig, TakesASensorOrASimulatedOne) {
  for (const char* fine :
       {"simulated: true", "sensor { address: '192.168.1.1' range_n: 100 }",
        "lever_mm: 120 sensor { address: '192.168.1.1' range_n: 100 dialect: ONROBOT }",
        "sensor { comedi {} range_n: 100 mount { turn_deg: [0, 0, 90] offset_mm: [0, 0, 40] } }",
        "sensor { enabled: false }"}) {
    EXPECT_EQ(handle_error(fine), "") << fine;
  }
}

TEST(HandleConfig, NamesWhatIsMissing) {
  EXPECT_THAT(handle_error(""), HasSubstr("'handle_sensor': neither sensor nor simulated"));
  EXPECT_THAT(handle_error("simulated: true sensor { address: '192.168.1.1' range_n: 9 }"),
              HasSubstr("'handle_sensor': both simulated and sensor, expected one of them"));
  EXPECT_EQ(handle_error("sensor { address: '192.168.1.1' }"),
            "c.conf:3:1: field 'handle_sensor.sensor.range_n': missing, expected the most that the "
            "sensor measures per axis, such as 100 N");
  EXPECT_THAT(handle_error("sensor { range_n: 100 }"),
              HasSubstr("c.conf:3:1: field 'handle_sensor.sensor.address': missing, expected the "
                        "sensor's IPv4 address"));
}

TEST(HandleConfig, NamesWhatIsWrongOfItsPlaceByItsOwnBlock) {
  const std::string at = "sensor { address: '192.168.1.1' range_n: 100 ";
  EXPECT_THAT(
      handle_error("sensor { address: 'here' range_n: 100 }"),
      HasSubstr("c.conf:3:10: field 'handle_sensor.sensor.address': 'here' is not an IPv4"));
  EXPECT_THAT(handle_error(at + "port: 0 }"),
              HasSubstr("'handle_sensor.sensor.port': 0 is no port to send to"));
  EXPECT_THAT(handle_error(at + "rate_hz: 500 }"),
              HasSubstr("'handle_sensor.sensor.rate_hz': only used with dialect: ONROBOT"));
  EXPECT_THAT(handle_error(at + "filter_ms: 5 }"),
              HasSubstr("'handle_sensor.sensor.filter_ms': only used with force_sensor"));
  EXPECT_THAT(handle_error(at + "mount { turn_deg: [150, 150, 0] } }"),
              HasSubstr("'handle_sensor.sensor.mount.turn_deg': 212.1 deg long, expected at most"));
  EXPECT_THAT(handle_error(at + "mount { turn_deg: [0, 0, 181] } }"),
              HasSubstr("'handle_sensor.sensor.mount.turn_deg[2]': 181 is outside -180 to 180"));
  EXPECT_THAT(handle_error(at + "comedi {} }"),
              HasSubstr("'handle_sensor.sensor.address': is for a sensor on the network"));
  EXPECT_THAT(handle_error("sensor { comedi { kind: ANALOG } range_n: 100 }"),
              HasSubstr("'handle_sensor.sensor.comedi.matrix': missing"));
  EXPECT_THAT(handle_error("simulated: true lever_mm: 0"),
              HasSubstr("'handle_sensor.lever_mm': 0 is outside 1 to 1000 mm"));
}

TEST(HandleConfig, NamesADeviceThatItDoesNotGoWith) {
  for (const char* kind : {"SPACEMOUSE", "TOUCH", "JOYSTICK", "GAMEPAD", "FORCE_STICK"}) {
    EXPECT_THAT(handle_error("simulated: true", std::string("device { kind: ") + kind + " }"),
                HasSubstr("'handle_sensor.simulated': true, but no simulated hand holds"))
        << kind;
  }
  const std::string device = "device { kind: JOYSTICK joystick { device: '/dev/comedi1' } }";
  EXPECT_THAT(handle_error("sensor { range_n: 100 comedi { device: '/dev/comedi1' } }", device),
              HasSubstr("'handle_sensor.sensor.comedi.device': '/dev/comedi1' is taken by "
                        "device.joystick.device"));
  EXPECT_EQ(handle_error("sensor { range_n: 100 comedi { device: '/dev/comedi0' } }", device), "");
}

}  // namespace
}  // namespace handrail
