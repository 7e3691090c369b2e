// Rig, slave and master over the encrypted link, with keys as their users make them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "server/keys/key_folder.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {

class SecureCell : public WholeCell {
 protected:
  void SetUp() override {
    make_keys();
    start_rig();
    launch_secure_slave();
    launch_secure_master();
  }
  void TearDown() override { ::unsetenv("HANDRAIL_KEYS"); }

  void make_keys() {
    const auto cell = at_slave.create("cell", Role::kSlave);
    const auto desk = at_master.create("desk", Role::kMaster);
    ASSERT_TRUE(cell && desk);
    TrustList masters, slaves;
    ASSERT_TRUE(masters.add(desk->entry()) && slaves.add(cell->entry()));
    ASSERT_TRUE(at_slave.save(masters, "a test") && at_master.save(slaves, "a test"));
  }
  std::unique_ptr<Program> launch_with(const std::string& keys, const std::string& name,
                                       const std::string& config, const std::string& link) {
    ::setenv("HANDRAIL_KEYS", keys.c_str(), 1);
    return std::make_unique<Program>(
        folder, name,
        std::vector<std::string>{"--config", folder.write(name + ".cfg", config), "--link", link});
  }
  void launch_secure_slave() {
    slave = launch_with(slave_keys, "handrail-slave",
                        "link_port: " + std::to_string(link_port) +
                            " robot { port: " + std::to_string(robot_port) +
                            " } force_sensor { port: " + std::to_string(sensor_port) + " }",
                        "127.0.0.1");
    link_port = slave->number_after("READY link=127.0.0.1:");
  }
  // `more`: of the master's configuration.
  void launch_secure_master(const std::string& more = {}) {
    // A hand without tremor and drift, so that it comes to rest.
    master =
        launch_with(master_keys, "handrail-master",
                    more + "operator_socket: '" + socket() +
                        "' device { hand { tremor_rms_mm: 0 drift_rms_mm: 0 drift_rms_deg: 0 } }",
                    "localhost:" + std::to_string(link_port));
    (void)master->after("READY link=any:");
  }
  bool connected() {
    return eventually([](const pb::Status& s) { return s.has_tip() && !s.peer().name().empty(); });
  }

  const std::string slave_keys = folder.path() + "/slave-keys";
  const std::string master_keys = folder.path() + "/master-keys";
  KeyFolder at_slave{slave_keys}, at_master{master_keys};
  int link_port = 0;
};

}  // namespace handrail
