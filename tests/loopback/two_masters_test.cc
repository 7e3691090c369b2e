// The real programs when two masters ask for one slave, and when one engages anew at once.
#include <gmock/gmock.h>

#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "server/base/own_places.h"
#include "server/model/reason.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class TwoMastersTest : public WholeCell {
 protected:
  // A second master for the same slave, with operators of its own.
  void start_second(const std::string& extra = "") {
    second = launch("handrail-master", "link_socket: '" + link_socket + "' operator_socket: '" +
                                           second_socket() + "' " + extra);
    (void)second->after("READY");
  }
  std::string second_socket() const { return folder.path() + "/second.sock"; }
  pb::Reply ask_second(const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    const Result<pb::Reply> reply = second_client.call(request, kPatience);
    EXPECT_TRUE(reply) << reply.message();
    return reply ? *reply : pb::Reply();
  }
  template <typename Condition>
  bool second_eventually(Condition condition) {
    const Nanos give_up = monotonic_now() + kPatience;
    pb::Status last;
    while (monotonic_now() < give_up && !HasFailure()) {
      last = ask_second("status: true").status();
      if (condition(last)) return true;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << "waited in vain; the second master's last status:\n" << last.DebugString();
    return false;
  }
  static bool fresh(const pb::Status& s) {
    return s.packet_age_ms() >= 0.0 && s.packet_age_ms() < 20.0;
  }
  static std::string led_by(const Program& other) {
    return std::string(describe(Reason::kOtherMaster)) + " (" + name_of(other) + ", for ";
  }

  std::unique_ptr<Program> second;
  OperatorClient second_client{second_socket()};
};

TEST_F(TwoMastersTest, TheSecondIsToldWhoLeadsAndTheFirstDrivesOn) {
  order("engage: true");
  start_second();
  EXPECT_TRUE(second_eventually([&](const pb::Status& s) {
    return s.reason().find(led_by(*master)) == 0 &&
           s.ledger().sentence().find(led_by(*master)) != std::string::npos;
  }));
  const pb::Reply engage = ask_second("engage: true");
  EXPECT_FALSE(engage.done());
  EXPECT_THAT(engage.reason(), HasSubstr(led_by(*master)));
  const pb::Reply stop = ask_second("stop: true");
  EXPECT_FALSE(stop.done());
  EXPECT_THAT(stop.reason(), HasSubstr(led_by(*master)));
  EXPECT_NE(second->after("the slave is led by another master (" + name_of(*master)), "");
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
}

TEST_F(TwoMastersTest, APausedMasterIsToldWhoTookItsPlaceAndComesBackWhenThatOneEnds) {
  start_second();
  ASSERT_TRUE(second_eventually(
      [&](const pb::Status& s) { return s.reason().find(led_by(*master)) == 0; }));
  master->send(SIGSTOP);
  ASSERT_TRUE(second_eventually([](const pb::Status& s) { return s.has_tip() && fresh(s); }));
  master->send(SIGCONT);
  EXPECT_TRUE(
      eventually([&](const pb::Status& s) { return s.reason().find(led_by(*second)) == 0; }));
  EXPECT_THAT(refusal("engage: true"), HasSubstr(led_by(*second)));
  EXPECT_NE(master->after("is led by another master (" + name_of(*second)), "");
  second->send(SIGTERM);
  EXPECT_EQ(second->finish(), 0);
  EXPECT_TRUE(eventually([](const pb::Status& s) { return fresh(s); }));
  EXPECT_TRUE(eventually([this](const pb::Status&) { return ask("engage: true").done(); }));
  EXPECT_TRUE(slave_reaches("engaged"));
}

TEST_F(TwoMastersTest, AMasterOfAWallsOnlySceneLeavesTheSlaveToAnother) {
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 0);
  client.close();
  start_second("scene: 'painted-aisle' device { kind: SIM_JOYSTICK }");
  sleep_until(monotonic_now() + kSecond / 2);
  start_master();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip() && fresh(s); }));
  order("engage: true");
  EXPECT_TRUE(second_eventually([](const pb::Status& s) { return s.slave_state() == "none"; }));
  EXPECT_TRUE(ask_second("stop: true").done());
  EXPECT_EQ(status().state(), "engaged");
}

// Before the slave's next cycle, of 7.1 ms.
TEST_F(TwoMastersTest, DisengagingAndEngagingAtOnceEngages) {
  order("engage: true");
  for (int round = 0; round < 60; ++round) {
    order("disengage: true");
    sleep_until(monotonic_now() + round % 12 * kMillisecond);
    order("engage: true");
    sleep_until(monotonic_now() + 20 * kMillisecond);
    const pb::Status s = status();
    ASSERT_EQ(s.state(), "engaged") << "round " << round << ": " << s.reason();
    ASSERT_EQ(s.slave_state(), "engaged") << "round " << round;
  }
}

// Its force sensor is a port where nobody answers.
class SilentSensorTest : public WholeCell {
 protected:
  SilentSensorTest() : silent_(io_, {boost::asio::ip::make_address(own_address()), 0}) {}
  void SetUp() override {
    start_rig();
    sensor_port = silent_.local_endpoint().port();
    start_slave();
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket silent_;
};

TEST_F(SilentSensorTest, EngagingWithoutTheSensorThatIsNeededIsRefusedWithThatReason) {
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.link_quality() == "EXCELLENT"; }));
  for (int i = 0; i < 3; ++i) {
    const std::string why = refusal("engage: true");
    EXPECT_THAT(why, HasSubstr(describe(Reason::kSensorMissing)));
    EXPECT_EQ(status().state(), "off");
    EXPECT_EQ(status().slave_state(), "off");
  }
}

}  // namespace
}  // namespace handrail
