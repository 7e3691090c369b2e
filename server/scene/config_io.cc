#include "server/scene/config_io.h"

#include <arpa/inet.h>
#include <sched.h>
#include <sys/un.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "server/base/own_places.h"
#include "server/base/plain_text.h"
#include "server/scene/cards/card_check.h"
#include "server/scene/cards/pad_check.h"
#include "server/scene/cards/sensor_check.h"
#include "server/scene/field_check.h"
#include "server/scene/text_io.h"

namespace handrail {
namespace {

// `field`: of an address to listen at.
Problem check_own_address(const char* field, const std::string& address) {
  if (address == "any") return std::nullopt;
  in6_addr parsed{};
  const std::string without_scope = address.substr(0, address.find('%'));
  if (::inet_pton(AF_INET, address.c_str(), &parsed) == 1 ||
      ::inet_pton(AF_INET6, without_scope.c_str(), &parsed) == 1) {
    return std::nullopt;
  }
  return FieldProblem{field, "'" + address +
                                 "': expected any, or an address of this computer, IPv4 such "
                                 "as 192.0.2.7 or IPv6 such as 2001:db8::7"};
}

struct Endpoint {
  const char* field;
  std::string address;
  std::uint32_t port;
};

Problem check_distinct(const std::vector<Endpoint>& ends) {
  for (std::size_t j = 1; j < ends.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (ends[i].port == 0 || ends[i].port != ends[j].port) continue;
      if (ends[i].address != ends[j].address) continue;
      return FieldProblem{ends[j].field,
                          std::to_string(ends[j].port) + " is taken by " + ends[i].field};
    }
  }
  return std::nullopt;
}

Problem first(std::initializer_list<Problem> problems) {
  for (const Problem& p : problems) {
    if (p) return p;
  }
  return std::nullopt;
}

Problem check_scene_name(const std::string& scene) {
  if (!scene.empty()) return std::nullopt;
  return FieldProblem{"scene", "empty, expected a scene's name such as linear-movement"};
}

template <typename Config>
Problem check_recording_folder(const Config& c) {
  if (!c.has_recording() || !c.recording().folder().empty()) return std::nullopt;
  return FieldProblem{"recording.folder", "empty, expected a folder"};
}

// `other`: the field that asks for the encrypted link, as `encrypted` says.
template <typename Config>
Problem check_link(const Config& c, bool encrypted, const char* other) {
  if (!c.has_link_socket()) return std::nullopt;
  if (encrypted) {
    return FieldProblem{"link_socket", "is for the plain link, but " + std::string(other) +
                                           " asks for the encrypted one: expected one of them"};
  }
  constexpr ::pid_t kLongest = 1 << 22;  // the kernel's PID_MAX_LIMIT
  const std::size_t beside = master_socket("", kLongest).size();
  const std::string problem = socket_path_problem(c.link_socket(), beside);
  return problem.empty() ? Problem() : FieldProblem{"link_socket", problem};
}

// Beside a thread that hardly sleeps little else would run.
template <typename Config>
Problem check_busy_poll(const Config& c) {
  cpu_set_t may_use;
  const bool known = sched_getaffinity(0, sizeof may_use, &may_use) == 0;  // not of over 1024
  if (!c.busy_poll() || !known || CPU_COUNT(&may_use) > 1) return std::nullopt;
  return FieldProblem{"busy_poll",
                      "true, but this program has one processor, expected two or more"};
}

// The blocks of devices that are not the one that is used would be read by nobody.
Problem check_device(const pb::DeviceConfig& c) {
  const bool spacemouse = c.kind() == pb::DeviceConfig::SPACEMOUSE;
  if (c.has_spacemouse() && !spacemouse) {
    return FieldProblem{"device.spacemouse", "only used with kind: SPACEMOUSE"};
  }
  if (c.has_touch() && c.kind() != pb::DeviceConfig::TOUCH) {
    return FieldProblem{"device.touch", "only used with kind: TOUCH"};
  }
  if (c.has_touch() && c.touch().library().empty()) {
    return FieldProblem{"device.touch.library", "empty, expected a library such as libHD.so"};
  }
  const pb::SpaceMouseConfig& mouse = c.spacemouse();
  if (mouse.has_socket()) {
    const std::string problem = socket_path_problem(mouse.socket());
    if (!problem.empty()) return FieldProblem{"device.spacemouse.socket", problem};
  }
  const auto taken = [](const char* field, std::uint32_t button, const char* by) {
    return FieldProblem{field, std::to_string(button) + " is taken by " + by};
  };
  if (mouse.drop_button() == mouse.clutch_button()) {
    return taken("device.spacemouse.drop_button", mouse.drop_button(), "clutch_button");
  }
  if (!mouse.has_enable_button()) return std::nullopt;
  const std::uint32_t enable = mouse.enable_button();
  if (enable == mouse.clutch_button()) {
    return taken("device.spacemouse.enable_button", enable, "clutch_button");
  }
  if (enable == mouse.drop_button()) {
    return taken("device.spacemouse.enable_button", enable, "drop_button");
  }
  return std::nullopt;
}

Problem check(const pb::MasterConfig& c) {
  Problem slave;
  if (c.has_slave() && c.slave().empty()) {
    slave = FieldProblem{"slave", "empty, expected HOST or HOST:PORT"};
  }
  Problem socket;
  const std::string socket_text =
      c.has_operator_socket() ? socket_path_problem(c.operator_socket()) : std::string();
  if (!socket_text.empty()) socket = FieldProblem{"operator_socket", socket_text};
  Problem operators;
  if (c.has_operator_address()) {
    operators = check_own_address("operator_address", c.operator_address());
  } else if (c.has_operator_port()) {
    operators = FieldProblem{"operator_port", "without operator_address, expected both or neither"};
  }
  Problem recording;
  const bool recorded = c.device().kind() == pb::DeviceConfig::RECORDED;
  if (recorded && c.device().recording().empty()) {
    recording = FieldProblem{"device.recording", "missing, but kind RECORDED plays a file"};
  } else if (!recorded && c.device().has_recording() &&
             c.device().kind() != pb::DeviceConfig::SIM_JOYSTICK) {
    recording = FieldProblem{"device.recording", "only used with kind: RECORDED or SIM_JOYSTICK"};
  }
  return first({slave, check_link(c, c.has_slave(), "slave"), socket, operators, recording,
                check_device(c.device()), check_pads(c.device()), check_joystick(c.device()),
                check_handle_sensor(c), check_recording_folder(c), check_scene_name(c.scene()),
                check_busy_poll(c)});
}

Problem check_payload(const pb::SlaveConfig& c) {
  const pb::PayloadConfig& payload = c.payload();
  if (!c.has_payload()) return std::nullopt;
  if (!c.force_sensor().enabled()) {
    return FieldProblem{"payload", "hangs on a force sensor, but force_sensor.enabled is false"};
  }
  if (payload.centre_mm_size() > 0 && payload.mass_kg() == 0.0) {
    return FieldProblem{"payload.centre_mm", "a centre without mass_kg, expected both or neither"};
  }
  for (int i = 0; i < payload.bias_n_size(); ++i) {
    if (std::abs(payload.bias_n(i)) < c.force_sensor().range_n()) continue;
    return FieldProblem{"payload.bias_n[" + std::to_string(i) + "]",
                        number_text(payload.bias_n(i)) +
                            " is not within the sensor's range, force_sensor.range_n: " +
                            number_text(c.force_sensor().range_n()) + " N"};
  }
  return std::nullopt;
}

// A packet sets one word of outputs.
Problem check_gripper(const pb::RobotConfig& robot) {
  constexpr int kWord = 16;
  if (!robot.gripper().has_open_output()) return std::nullopt;
  const int close = static_cast<int>(robot.gripper().close_output());
  const int open = static_cast<int>(robot.gripper().open_output());
  if (open != close && std::abs(open - close) < kWord) return std::nullopt;
  return FieldProblem{"robot.gripper.open_output",
                      std::to_string(open) + ", expected another than close_output, " +
                          std::to_string(close) + ", and at most 15 from it"};
}

// A program's name goes into an order of text, as it is.
Problem check_program(const char* field, const std::string& name) {
  constexpr char kMayHave[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  const bool odd = name.find_first_not_of(kMayHave) != std::string::npos;
  if (!odd && !name.empty() && name.size() <= 32) return std::nullopt;
  return FieldProblem{field, "'" + shown(name) + "', expected 1 to 32 letters, digits, _ or -"};
}

Problem check(const pb::SlaveConfig& c) {
  Problem stop;
  if (c.has_stop_switch() && !c.stop_switch().device().starts_with("/")) {
    stop = FieldProblem{"stop_switch.device",
                        "'" + shown(c.stop_switch().device()) +
                            "', expected the path of an input device, from / on"};
  }
  Problem bytes;
  const std::uint32_t n = c.robot().packet_bytes();
  if (n != 64 && n != 196) {
    bytes = FieldProblem{"robot.packet_bytes", std::to_string(n) + " is neither 64 nor 196"};
  }
  std::vector<Endpoint> ends = {{"robot.port", c.robot().address(), c.robot().port()}};
  Problem sensor;
  if (c.force_sensor().enabled()) sensor = check_sensor(c.force_sensor(), "force_sensor");
  if (c.force_sensor().enabled() && !c.force_sensor().has_comedi()) {
    ends.push_back({"force_sensor.port", c.force_sensor().address(), c.force_sensor().port()});
  }
  Problem address, program;
  if (c.robot().has_program()) program = check_program("robot.program", c.robot().program());
  if (c.has_link_address()) address = check_own_address("link_address", c.link_address());
  return first({address, check_link(c, c.has_link_address(), "link_address"),
                check_link(c, c.has_link_port(), "link_port"),
                check_ipv4("robot.address", c.robot().address()),
                check_peer_port("robot.port", c.robot().port()), bytes, check_gripper(c.robot()),
                program, sensor, check_payload(c), check_recording_folder(c),
                check_scene_name(c.scene()), check_distinct(ends), stop, check_busy_poll(c)});
}

Problem check(const pb::RigConfig& c) {
  Problem tap;
  if (c.has_tap() && c.tap().empty()) tap = FieldProblem{"tap", "empty, expected a file's name"};
  return first({tap, check_ipv4("address", c.address()),
                check_program("switches.program", c.switches().program()),
                check_distinct({{"robot_port", c.address(), c.robot_port()},
                                {"sensor_port", c.address(), c.sensor_port()}})});
}

std::string from_folder_of(const std::string& file, const std::string& path) {
  const std::filesystem::path p(path);
  if (path.empty() || p.is_absolute()) return path;
  return (std::filesystem::path(file).parent_path() / p).string();
}

template <typename Config>
void resolve_scene_path(const std::string& file, Config& config) {
  for (std::string& folder : *config.mutable_scene_path()) folder = from_folder_of(file, folder);
}

// The path of the plain link as it is to be used.
template <typename Config>
void resolve_link_socket(const std::string& file, Config& config) {
  config.set_link_socket(config.has_link_socket() ? from_folder_of(file, config.link_socket())
                                                  : default_link_socket());
}

template <typename Config>
void resolve_recording(const std::string& file, Config& config) {
  if (!config.has_recording()) return;
  pb::RecordingConfig& recording = *config.mutable_recording();
  recording.set_folder(from_folder_of(file, recording.folder()));
}

// Of a controller's switches: its real-time port is followed by the other one (10000, 10001).
std::uint32_t port_after(std::uint32_t port) { return port == 0 ? 0 : port % 65535 + 1; }

void set_addresses(pb::MasterConfig&) {}  // it listens at none
void set_addresses(pb::SlaveConfig& c) {
  pb::RobotConfig& robot = *c.mutable_robot();
  if (!robot.has_address()) robot.set_address(own_address());
  if (!robot.has_command_port()) robot.set_command_port(port_after(robot.port()));
  if (c.force_sensor().has_comedi() || c.force_sensor().has_address()) return;
  c.mutable_force_sensor()->set_address(own_address());
}
void set_addresses(pb::RigConfig& c) {
  if (!c.has_address()) c.set_address(own_address());
}

// What was typed in place of a field.
struct Typed {
  const char* option;
  const char* field;
  const std::string& value;  // empty: it was not
};

void set_typed(pb::MasterConfig& c, const Typed& typed) {
  std::string_view(typed.field) == "slave" ? c.set_slave(typed.value)
                                           : c.set_operator_address(typed.value);
}
void set_typed(pb::SlaveConfig& c, const Typed& typed) { c.set_link_address(typed.value); }
void set_typed(pb::RigConfig&, const Typed&) {}

template <typename Config>
Result<Config> load(const std::string& path, std::initializer_list<Typed> typed = {}) {
  Config config;
  TextSource source;
  if (!path.empty()) {
    if (Status status = source.load(path, config); !status) return status;
  }
  for (const Typed& one : typed) {
    if (!one.value.empty()) set_typed(config, one);
  }
  set_addresses(config);
  const Problem problem = check(config);
  if (!problem) return config;
  for (const Typed& one : typed) {
    if (!one.value.empty() && problem->path == one.field) {
      return Status::error(std::string(one.option) + " " + problem->text);
    }
  }
  return source.error_at(*problem);
}

}  // namespace

std::string socket_path_problem(const std::string& path, std::size_t beside) {
  const std::size_t longest = sizeof(sockaddr_un{}.sun_path) - 1 - beside;
  if (path.empty()) return "empty, expected the path of a Unix socket";
  if (path.size() <= longest) return {};
  return "a path of " + std::to_string(path.size()) + " bytes, but a Unix socket's path has " +
         (beside == 0 ? "" : "room here for ") + "at most " + std::to_string(longest);
}

Result<pb::MasterConfig> load_master_config(const std::string& path, const std::string& link,
                                            const std::string& operators) {
  Result<pb::MasterConfig> config = load<pb::MasterConfig>(
      path, {{"--link", "slave", link}, {"--operators", "operator_address", operators}});
  if (!config) return config;
  resolve_scene_path(path, *config);
  resolve_link_socket(path, *config);
  resolve_recording(path, *config);
  if (!config->has_operator_socket()) config->set_operator_socket(default_operator_socket());
  if (config->device().spacemouse().has_socket()) {
    pb::SpaceMouseConfig& mouse = *config->mutable_device()->mutable_spacemouse();
    mouse.set_socket(from_folder_of(path, mouse.socket()));
  }
  if (config->has_device()) resolve_libraries(path, *config->mutable_device());
  if (config->handle_sensor().has_sensor()) {
    resolve_libraries(path, *config->mutable_handle_sensor()->mutable_sensor());
  }
  if (config->device().has_recording()) {
    config->mutable_device()->set_recording(from_folder_of(path, config->device().recording()));
  }
  return config;
}

Result<pb::SlaveConfig> load_slave_config(const std::string& path, const std::string& link) {
  Result<pb::SlaveConfig> config = load<pb::SlaveConfig>(path, {{"--link", "link_address", link}});
  if (!config) return config;
  if (config->has_force_sensor()) resolve_libraries(path, *config->mutable_force_sensor());
  resolve_scene_path(path, *config);
  resolve_link_socket(path, *config);
  resolve_recording(path, *config);
  return config;
}

Result<pb::RigConfig> load_rig_config(const std::string& path) {
  Result<pb::RigConfig> config = load<pb::RigConfig>(path);
  if (!config) return config;
  resolve_scene_path(path, *config);
  if (config->has_tap()) config->set_tap(from_folder_of(path, config->tap()));
  if (config->has_status_socket())
    config->set_status_socket(from_folder_of(path, config->status_socket()));
  return config;
}

}  // namespace handrail
