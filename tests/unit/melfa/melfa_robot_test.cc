// The driver over a real socket, against a peer that plays bytes written by hand.
#include "devices/melfa/melfa_robot.h"

#include <gtest/gtest.h>

#include "server/base/clock.h"
#include "tests/support/mxt/scripted_mxt_peer.h"

namespace handrail {
namespace {

using golden::Packet;
using test::ScriptedMxtPeer;

constexpr Nanos kNoHurry = 30 * kSecond;
// The peer answers at once, in the cycle of the reply before: that is told at this cycle's end.
// Long, so that the opening's second reply is in time on a busy machine.
constexpr Nanos kCycle = 100 * kMillisecond;

MelfaOptions options_for(const ScriptedMxtPeer& peer, Nanos period, std::size_t size = kMxtLong) {
  MelfaOptions options;
  options.port = peer.port();
  options.client.period = period;
  options.client.packet_bytes = size;
  return options;
}

// A session opens with four packets.
void open_long(ScriptedMxtPeer& peer) {
  peer.expect(golden::null_long()).reply(golden::reply_long());
  for (std::uint8_t i = 1; i <= 3; ++i) {
    peer.expect(golden::null_long_held(i)).reply(golden::reply_long_held());
  }
}

// Waits until something was said.
bool hears(MelfaRobot& robot, RobotReply& reply) {
  RobotEvent event = robot.wait(reply);
  while (event == RobotEvent::kSilence && !reply.fresh) event = robot.wait(reply);
  return event == RobotEvent::kReply || event == RobotEvent::kSilence;
}

TEST(MelfaRobot, SpeaksTheGoldenConversation) {
  ScriptedMxtPeer peer;
  open_long(peer);
  peer.expect(golden::move_long(4)).reply(golden::reply_long());
  peer.expect(golden::move_long(5)).reply(golden::reply_long());
  peer.expect(golden::end_long(6));
  peer.play();
  MelfaRobot robot(options_for(peer, kCycle));
  RobotReply reply;
  const Status connected = robot.connect(kNoHurry, reply);
  ASSERT_TRUE(connected) << connected.message();
  EXPECT_EQ(reply.q_measured, golden::kMeasured);
  EXPECT_EQ(reply.q_commanded, golden::kTarget);
  for (int i = 0; i < 2; ++i) {
    robot.send(golden::kTarget);
    EXPECT_TRUE(hears(robot, reply));
  }
  robot.end();
  robot.end();
  EXPECT_EQ(robot.counters().sent, 7u);
  EXPECT_EQ(robot.counters().replies, 6u);
}

TEST(MelfaRobot, SpeaksTheShortFormToOldControllers) {
  ScriptedMxtPeer peer;
  peer.expect(golden::null_short()).reply(golden::reply_short());
  for (std::uint8_t i = 1; i <= 3; ++i) {
    peer.expect(golden::null_short_held(i)).reply(golden::reply_short_held());
  }
  peer.expect(golden::move_short(4)).reply(golden::reply_short());
  peer.expect(golden::end_short(5));
  peer.play();
  MelfaRobot robot(options_for(peer, kCycle, kMxtShort));
  RobotReply reply;
  ASSERT_TRUE(robot.connect(kNoHurry, reply));
  robot.send(golden::kTarget);
  EXPECT_TRUE(hears(robot, reply));
  robot.end();
}

TEST(MelfaRobot, ReportsGarbageOnceAndWaitsOnForTheReply) {
  ScriptedMxtPeer peer;
  open_long(peer);
  peer.expect(golden::move_long(4)).reply(Packet{1, 2, 3}).reply(golden::reply_short());
  peer.expect(golden::move_long(5)).reply(golden::reply_long());
  peer.expect(golden::end_long(6));
  peer.play();
  MelfaRobot robot(options_for(peer, kCycle));
  RobotReply reply;
  ASSERT_TRUE(robot.connect(kNoHurry, reply));
  robot.send(golden::kTarget);
  while (robot.counters().rejected < 2) (void)robot.wait(reply);
  robot.send(golden::kTarget);
  EXPECT_TRUE(hears(robot, reply));
  robot.end();
}

TEST(MelfaRobot, SendsNothingByItselfWhenTheControllerIsSilent) {
  ScriptedMxtPeer peer;
  open_long(peer);
  peer.expect(golden::move_long(4));
  peer.expect(golden::move_long(5)).ignore_the_rest();
  peer.play();
  MelfaRobot robot(options_for(peer, 500 * kMillisecond));
  RobotReply reply;
  ASSERT_TRUE(robot.connect(kNoHurry, reply));
  robot.send(golden::kTarget);
  EXPECT_EQ(robot.wait(reply), RobotEvent::kSilence);
  EXPECT_EQ(robot.counters().silences, 1u);
  EXPECT_EQ(robot.counters().sent, 5u);
  robot.send(golden::kTarget);
}

TEST(MelfaRobot, LosesTheSessionOfAControllerThatStaysSilent) {
  ScriptedMxtPeer silent;
  silent.ignore_the_rest().play();
  MelfaRobot robot(options_for(silent, 100 * kMicrosecond));
  RobotReply reply;
  const Status connected = robot.connect(kNoHurry, reply);
  EXPECT_FALSE(connected);
  EXPECT_NE(connected.message().find(std::to_string(silent.port())), std::string::npos)
      << connected.message();
  EXPECT_EQ(robot.counters().silences, 210u);
  EXPECT_EQ(robot.wait(reply), RobotEvent::kLost);
  robot.send(golden::kTarget);
  EXPECT_EQ(robot.counters().sent, 211u);
}

TEST(MelfaRobot, ConnectTakesNoLongerThanItMayWhenTheOpeningFails) {
  ScriptedMxtPeer peer;
  peer.expect(golden::null_long()).reply(golden::reply_long()).ignore_the_rest();
  peer.play();
  MelfaRobot robot(options_for(peer, kCycle));
  RobotReply reply;
  const Nanos from = monotonic_now();
  EXPECT_FALSE(robot.connect(4 * kCycle, reply));
  EXPECT_LT(monotonic_now() - from, 10 * kCycle) << "the opening is tried again after 16 cycles";
}

TEST(MelfaRobot, NamesAddressAndCauseWhenItCannotConnect) {
  RobotReply reply;
  MelfaOptions options;
  options.address = "robot.example";
  EXPECT_NE(MelfaRobot(options).connect(kSecond, reply).message().find("'robot.example'"),
            std::string::npos);
  options = MelfaOptions{};
  options.client.packet_bytes = 65;
  EXPECT_NE(MelfaRobot(options).connect(kSecond, reply).message().find("65"), std::string::npos);
}

TEST(MelfaRobot, SaysThatTheAnswersHadTheWrongSize) {
  ScriptedMxtPeer peer;
  peer.expect(golden::null_long()).reply(golden::reply_short()).ignore_the_rest();
  peer.play();
  MelfaRobot robot(options_for(peer, 2 * kMillisecond));
  RobotReply reply;
  const std::string message = robot.connect(kNoHurry, reply).message();
  EXPECT_NE(message.find("196"), std::string::npos) << message;
  EXPECT_NE(message.find("packet_bytes"), std::string::npos) << message;
}

}  // namespace
}  // namespace handrail
