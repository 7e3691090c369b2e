#include "server/scene/field_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "proto/config.pb.h"
#include "proto/scene.pb.h"

namespace handrail {
namespace {

std::string complaint(const google::protobuf::Message& m) {
  const auto problem = check_fields(m);
  return problem ? to_sentence(*problem) : "";
}

TEST(FieldCheck, AcceptsBothEndsOfARange) {
  pb::Guidance g;
  g.set_stiffness_n_mm(10.0);
  EXPECT_EQ(complaint(g), "");
  g.set_stiffness_n_mm(0.0);
  EXPECT_EQ(complaint(g), "");
}

TEST(FieldCheck, RefusesTheNextNumberPastARange) {
  pb::Guidance g;
  g.set_stiffness_n_mm(std::nextafter(10.0, 11.0));
  EXPECT_EQ(complaint(g), "field 'stiffness_n_mm': 10.000000000000002 is outside 0 to 10 N/mm");
}

TEST(FieldCheck, RefusesNumbersThatAreNotFiniteEvenWithoutARange) {
  pb::Scene scene;
  scene.set_name("a");
  scene.add_tool()->set_kind(pb::Tool::POINT);
  scene.mutable_tool(0)->add_at_mm(0);
  scene.mutable_tool(0)->add_at_mm(std::numeric_limits<double>::quiet_NaN());
  scene.mutable_tool(0)->add_at_mm(0);
  EXPECT_EQ(complaint(scene), "field 'tool[0].at_mm[1]': nan is not a finite number");
}

TEST(FieldCheck, ChecksWholeNumbersAndListElements) {
  pb::RigConfig rig;
  for (int i = 0; i < 6; ++i) rig.add_joint_lag_ms(i == 4 ? 61 : 45);
  EXPECT_EQ(complaint(rig), "field 'joint_lag_ms[4]': 61 is outside 30 to 60 ms");
  pb::SlaveConfig slave;
  slave.set_link_port(65536);
  EXPECT_EQ(complaint(slave), "field 'link_port': 65536 is outside 0 to 65535");
  pb::RigConfig timeout;
  timeout.set_mxttout_cycles(-2);
  EXPECT_EQ(complaint(timeout), "field 'mxttout_cycles': -2 is outside -1 to 100000");
}

TEST(FieldCheck, CountsElementsOnlyWhenAnyAreGiven) {
  pb::RigConfig rig;
  EXPECT_EQ(complaint(rig), "");
  rig.add_start_joints_deg(0);
  EXPECT_EQ(complaint(rig), "field 'start_joints_deg': 1 value, expected 6");
}

TEST(FieldCheck, SaysWhatIsMissingAfterWhatIsWrong) {
  pb::Scene scene;
  EXPECT_EQ(complaint(scene), "field 'name': missing, but required");
  scene.mutable_bumper()->set_threshold_n(-1);
  EXPECT_EQ(complaint(scene), "field 'bumper.threshold_n': -1 is outside 0.1 to 1000 N");
}

TEST(FieldCheck, RefusesTextWithControlCharacters) {
  pb::MasterConfig config;
  config.set_operator_socket(std::string("/tmp/a\0b", 8));
  EXPECT_EQ(complaint(config), "field 'operator_socket': not plain UTF-8 text");
}

}  // namespace
}  // namespace handrail
