// handrail devices and doctor beside real programs: they find arm and sensor, and leave alone what
// a slave leads.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>

#include <map>

#include "proto/devices.pb.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class DevicesOfACell : public WholeCell {
 protected:
  std::vector<std::string> files() const {
    return {"--slave-config", folder.path() + "/handrail-slave.cfg", "--master-config",
            folder.path() + "/handrail-master.cfg"};
  }
  std::pair<int, std::string> run(std::vector<std::string> words) {
    const std::vector<std::string> more = files();
    words.insert(words.end(), more.begin(), more.end());
    return handrail(words);
  }
  std::map<std::string, pb::DeviceRow> list() {
    pb::DeviceList out;
    const auto [code, text] = run({"devices", "list", "--json"});
    EXPECT_EQ(code, 0) << text;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(text, &out).ok()) << text;
    std::map<std::string, pb::DeviceRow> rows;
    for (const pb::DeviceRow& row : out.devices()) rows[row.name()] = row;
    return rows;
  }
};

TEST_F(DevicesOfACell, WhatASlaveLeadsIsLeftAloneWhileTheArmIsEngaged) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  const pb::Status before = at_rest();
  for (const char* name : {"melfa", "net-ft"}) {
    EXPECT_THAT(list()[name].fact(), HasSubstr("another program of this computer"));
    const auto [code, text] = run({"devices", "test", name});
    EXPECT_EQ(code, 1) << text;
  }
  const auto [code, text] = run({"doctor"});
  EXPECT_THAT(text, HasSubstr("device.melfa: 127.0.0.1:" + std::to_string(robot_port)));
  EXPECT_THAT(text, HasSubstr("the slave has sound readings of its force sensor"));
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
  EXPECT_LT((mm(at_rest().tip()) - mm(before.tip())).norm(), 0.1);
}

TEST_F(DevicesOfACell, WithoutASlaveArmAndSensorAreFoundTestedAndLeftToTheNextSlave) {
  slave->kill();
  EXPECT_THAT(list()["melfa"].fact(), HasSubstr("answers with 196 bytes"));
  EXPECT_EQ(list()["net-ft"].readiness(), pb::DeviceRow::READY);
  const auto [code, text] = run({"devices", "test", "net-ft", "--alone", "--json"});
  // What is asked of the person stands before it, on the error output.
  pb::DeviceTestReport report;
  ASSERT_TRUE(
      google::protobuf::util::JsonStringToMessage(text.substr(text.find('{')), &report).ok())
      << text;
  EXPECT_EQ(report.daemon(), "handrail-slave");
  EXPECT_THAT(report.block(), HasSubstr("port: " + std::to_string(sensor_port)));
  EXPECT_THAT(run({"devices", "test", "melfa"}).second, HasSubstr("joints"));
  EXPECT_THAT(run({"devices", "calibrate", "melfa"}).second, HasSubstr("packet_bytes: 196"));
  start_slave();
  // A slave that began anew is told so once; then it is engaged again.
  ASSERT_TRUE(within(kPatience, [this] { return ask("engage: true").done(); }));
  EXPECT_TRUE(slave_reaches("engaged"));
}

}  // namespace
}  // namespace handrail
