// Rig, slave and master as real programs on free ports, driven through the operators' socket.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/api/operator_client.h"
#include "server/base/own_places.h"
#include "server/base/spatial.h"
#include "tests/loopback/program.h"

namespace handrail {

class WholeCell : public ::testing::Test {
 protected:
  static constexpr Nanos kPatience = Program::kPatience;

  void SetUp() override {
    start_rig();
    start_slave();
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }))
        << "no slave with an arm";
  }

  void start_rig() {
    rig = launch("handrail-rig", "robot_port: " + std::to_string(robot_port) +
                                     " sensor_port: " + std::to_string(sensor_port) +
                                     " repeatability_mm: 0 " + rig_extra);
    robot_port = rig->number_after("READY robot_port=");
    sensor_port = rig->number_after(" sensor_port=");
  }
  void launch_slave() {
    slave = launch("handrail-slave", "link_socket: '" + link_socket + "' robot { port: " +
                                         std::to_string(robot_port) + " " + robot_extra +
                                         " } force_sensor { port: " + std::to_string(sensor_port) +
                                         " } " + slave_extra);
  }
  void start_slave() {
    launch_slave();
    EXPECT_EQ(slave->after("READY link="), link_socket);
  }
  void start_master() {
    master = launch("handrail-master", master_config());
    EXPECT_TRUE(master->after("READY link=").starts_with(master_place(*master) + " "));
  }
  // A hand without tremor and drift, so that what moves is what was told to.
  std::string master_config() const {
    return "link_socket: '" + link_socket + "' operator_socket: '" + socket() + "' scene_path: '" +
           folder.path() + "' device { " + device_kind +
           " hand { tremor_rms_mm: 0 drift_rms_mm: 0 drift_rms_deg: 0 } } " + master_extra;
  }
  std::unique_ptr<Program> launch(const std::string& name, const std::string& config) const {
    return std::make_unique<Program>(
        folder, name, std::vector<std::string>{"--config", folder.write(name + ".cfg", config)},
        streams);
  }
  // Where the slave's datagrams to that master go.
  std::string master_place(const Program& program) const {
    return master_socket(link_socket, program.pid());
  }
  // How that master is named where it leads the slave.
  static std::string name_of(const Program& program) {
    return "process " + std::to_string(program.pid()) + " on this computer";
  }
  std::string socket() const { return folder.path() + "/operator/operator.sock"; }

  // One request in text format through the client library.
  pb::Reply ask(const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    const Result<pb::Reply> reply = client.call(request, kPatience);
    EXPECT_TRUE(reply) << reply.message();
    return reply ? *reply : pb::Reply();
  }
  // A link that a busy machine disturbed is waited for, as a person does.
  void order(const std::string& text) {
    const Nanos give_up = monotonic_now() + kPatience;
    pb::Reply reply = ask(text);
    while (reply.reason().find("the link is not good enough") != std::string::npos &&
           monotonic_now() < give_up) {
      sleep_until(monotonic_now() + 50 * kMillisecond);
      reply = ask(text);
    }
    ASSERT_TRUE(reply.done()) << text << ": " << reply.reason();
  }
  std::string refusal(const std::string& text) {
    const pb::Reply reply = ask(text);
    EXPECT_FALSE(reply.done()) << text;
    return reply.reason();
  }
  pb::Status status() { return ask("status: true").status(); }

  // Asks for the status until `condition` holds for it.
  template <typename Condition>
  bool eventually(Condition condition) {
    const Nanos give_up = monotonic_now() + kPatience;
    pb::Status last;
    while (monotonic_now() < give_up && !HasFailure()) {
      last = status();
      if (condition(last)) return true;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << "waited in vain; the last status:\n" << last.DebugString();
    return false;
  }
  bool within(Nanos patience, const std::function<bool()>& condition) {
    for (const Nanos give_up = monotonic_now() + patience; monotonic_now() < give_up;) {
      if (condition()) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return false;
  }
  bool reaches(const std::string& state) {
    return eventually([&](const pb::Status& s) { return s.state() == state; });
  }
  bool slave_reaches(const std::string& state) {
    return eventually([&](const pb::Status& s) { return s.slave_state() == state; });
  }
  // Until hand and arm have come to rest.
  pb::Status at_rest() {
    pb::Status last;
    Vec3 before = Vec3::Zero();
    int still = 0;
    (void)eventually([&](const pb::Status& s) {
      const Vec3 now = mm(s.slave_command());
      still = !s.hand_moving() && (now - before).norm() < 1e-3 ? still + 1 : 0;
      before = now;
      last = s;
      return still > 60;
    });
    return last;
  }
  // A move of the simulated hand, from order to rest. Right, up, toward the user [mm].
  pb::Status move_hand(const std::string& by_mm) {
    order("hand { displacement_mm: [" + by_mm + "] duration_s: 0.5 }");
    return at_rest();
  }
  static Vec3 mm(const pb::PoseMm& pose) {
    if (pose.position_mm_size() != 3) return Vec3::Zero();
    return Vec3(pose.position_mm(0), pose.position_mm(1), pose.position_mm(2));
  }
  // The command line, as an operator types it: exit code and output.
  std::pair<int, std::string> handrail(std::vector<std::string> words) {
    words.insert(words.end(), {"--socket", socket()});
    Program program(folder, "handrail", std::move(words));
    const int code = program.finish();
    return {code, program.output()};
  }

  TempFolder folder;
  int robot_port = 0, sensor_port = 0;
  std::string link_socket = folder.path() + "/link.sock";  // where slave and master meet
  std::string rig_extra, robot_extra, slave_extra, master_extra, device_kind;
  Streams streams;  // of what is launched next
  std::unique_ptr<Program> rig, slave, master;
  OperatorClient client{socket()};
};

}  // namespace handrail
