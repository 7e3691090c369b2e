// The simulated controller's switches, by golden lines, and over TCP with the client that a user
// has.
#include "devices/rig/switches.h"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "devices/melfa/melfa_driver.h"
#include "devices/melfa/r3_socket.h"
#include "devices/rig/rig_server.h"
#include "devices/rig/switches_server.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

constexpr PeerId kMe = 1, kOther = 2;

class SwitchesAlone : public ::testing::Test {
 protected:
  std::string say(const std::string& order, PeerId peer = kMe) {
    return switches.answer("1;1;" + order, peer, now, controller);
  }
  void begin(const SwitchesOptions& options) { switches = Switches(options); }

  Controller controller{ControllerOptions{}};
  Switches switches{SwitchesOptions{}};
  Nanos now = kSecond;
};

TEST_F(SwitchesAlone, SayTheLinesThatPublicClientsRead) {
  EXPECT_EQ(say("STATE"), "QoK1;20;100;0;60000;1;1;;;;;;;;1;CYC;START;1;1");
  EXPECT_EQ(say("DSTATE"), "QoK60000;1;1");
  EXPECT_EQ(say("OVRD"), "QoK100");
  EXPECT_EQ(say("CNTLON"), "QoK");
  EXPECT_EQ(say("DSTATE"), "QoKE0000;1;1");
  EXPECT_EQ(say("OVRD=25"), "QoK25");
  EXPECT_EQ(say("STOP\r"), "QoK");
  // As an RV-2A that stands said of its stop byte.
  EXPECT_EQ(say("DSTATE"), "QoKA0060;1;1");
  EXPECT_EQ(say("SRVOFF"), "QoK");
  EXPECT_EQ(say("DSTATE"), "QoK80060;1;1");
}

TEST_F(SwitchesAlone, TheServosTakeTheirTimeAndTheProgramNeedsThem) {
  begin({.on = false});
  EXPECT_EQ(say("SRVON"), "QeR9201");
  EXPECT_EQ(say("CNTLON"), "QoK");
  EXPECT_EQ(say("SRVON"), "QoK");
  EXPECT_EQ(say("RUN1;1"), "QeR9203");
  now += Switches::kServoRise - 1;
  EXPECT_EQ(say("DSTATE"), "QoK80060;1;1");
  now += 1;
  EXPECT_EQ(say("DSTATE"), "QoKA0060;1;1");
  EXPECT_EQ(say("SLOTINIT"), "QoK");
  EXPECT_EQ(say("RUNx;1"), "QeR9204");
  EXPECT_EQ(say("RUN1;1"), "QoK");
  EXPECT_EQ(say("DSTATE"), "QoKE0000;1;1");
  EXPECT_EQ(say("SLOTINIT"), "QeR9209");
}

TEST_F(SwitchesAlone, TheRightIsOnesUntilItIsGivenBackOrGone) {
  EXPECT_EQ(say("CNTLON"), "QoK");
  EXPECT_EQ(say("CNTLON", kOther), "QeR9200");
  EXPECT_EQ(say("OVRD=50", kOther), "QeR9201");
  EXPECT_EQ(say("CNTLOFF", kOther), "QeR9201");
  switches.left(kOther);
  EXPECT_EQ(say("CNTLON", kOther), "QeR9200");
  switches.left(kMe);
  EXPECT_EQ(say("CNTLON", kOther), "QoK");
  begin({.rights_taken = true});
  EXPECT_EQ(say("CNTLON"), "QeR9200");
}

TEST_F(SwitchesAlone, ModeAndEmergencyStopAreSeenAndKeepTheServosOff) {
  begin({.on = false, .teach = true, .override_percent = 30});
  EXPECT_EQ(say("STATE"), "QoK1;10;30;0;08060;1;1;;;;;;;;1;CYC;START;1;1");
  say("CNTLON");
  EXPECT_EQ(say("SRVON"), "QeR9202");
  begin({.emergency_stop = true});
  EXPECT_EQ(say("DSTATE"), "QoK00070;1;1");
  say("CNTLON");
  EXPECT_EQ(say("SRVON"), "QeR9206");
}

TEST_F(SwitchesAlone, AnAlarmMakesTheLettersSmallAndStopsTheProgramUntilItRunsAgain) {
  MxtPacket open;
  std::array<std::uint8_t, kMxtLong> bytes{};
  controller.on_datagram(encode_mxt(open, kMxtLong, bytes), 7);
  controller.tick(now);
  MxtPacket move;
  move.command = MxtCommand::kMove;
  move.send_type = MxtType::kJoint;
  move.block[0].set_joints(JointVector::Constant(1.0));
  controller.on_datagram(encode_mxt(move, kMxtLong, bytes), 7);
  controller.tick(now + kMxtPeriod);
  ASSERT_NE(controller.alarm().kind, AlarmKind::kNone);
  const std::string state = say("DSTATE");
  EXPECT_EQ(state.substr(0, 9), "Qok200692") << state;
  EXPECT_EQ(say("ERRORMES" + state.substr(7, 4)).substr(0, 3), "Qok");
  EXPECT_GT(say("ERRORMES" + state.substr(7, 4)).size(), 10u);
  EXPECT_EQ(say("CNTLON"), "Qok");
  EXPECT_EQ(say("SLOTINIT"), "Qer9205");
  EXPECT_EQ(say("RSTALRM"), "QoK");
  EXPECT_EQ(controller.alarm().kind, AlarmKind::kNone);
  EXPECT_EQ(say("DSTATE"), "QoKA0060;1;1");
  EXPECT_EQ(say("RUN1;1"), "QoK");
  EXPECT_EQ(say("DSTATE"), "QoKE0000;1;1");
}

TEST_F(SwitchesAlone, OrdersThatAreNoneAreRefused) {
  for (const char* order : {"", "STATES", "ERRORMESx", "OVRD=", "1;1;STATE"}) {
    say("CNTLON");
    EXPECT_EQ(say(order).substr(0, 3), "QeR") << order;
  }
  EXPECT_EQ(switches.answer("STATE", kMe, now, controller).substr(0, 3), "QeR");
  EXPECT_EQ(say("OVRD=0"), "QeR9208");
  EXPECT_EQ(say("OVRD=101"), "QeR9208");
}

// A rig on the network, and what a user's program does at its switches.
class SwitchesOnTheNetwork : public ::testing::Test {
 protected:
  void start(const SwitchesOptions& switches) {
    RigOptions options;
    options.switches = switches;
    server.emplace(options);
    ASSERT_TRUE(server->open("127.0.0.1", 0, 0));
    ASSERT_TRUE(server->open_switches("127.0.0.1", 0));
    ASSERT_NE(server->command_port(), 0);
    thread = std::thread([this] { server->run(); });
  }
  ~SwitchesOnTheNetwork() override {
    if (!thread.joinable()) return;
    server->stop();
    thread.join();
  }
  std::unique_ptr<R3Socket> line(R3Socket::Interrupted interrupted = {}) {
    auto out = R3Socket::connect("127.0.0.1", server->command_port(), std::move(interrupted));
    EXPECT_TRUE(out) << out.message();
    return std::move(*out);
  }
  MelfaOptions robot() {
    MelfaOptions out;
    out.port = server->robot_port();
    out.command_port = server->command_port();
    out.program = "1";
    return out;
  }
  bool answers() {
    MelfaRobot arm(robot());
    RobotReply first;
    return arm.connect(300 * kMillisecond, first).is_ok();
  }

  std::optional<RigServer> server;
  std::thread thread;
};

TEST_F(SwitchesOnTheNetwork, OnMakesRealTimeControlAnswerAndOffEndsIt) {
  start({.on = false});
  EXPECT_FALSE(answers());
  const SwitchesReport on = switch_on(*line(), {"1", std::nullopt});
  EXPECT_TRUE(on.done) << on.problem.fact;
  EXPECT_TRUE(answers());
  EXPECT_FALSE(on.after->status.rights_taken());
  const SwitchesReport off = switch_off(*line());
  EXPECT_TRUE(off.done) << off.problem.fact;
  EXPECT_FALSE(answers());
}

TEST_F(SwitchesOnTheNetwork, WhoOperatesItKeepsOthersFromItAndLetsThemLook) {
  start({.on = false});
  const auto first = line();
  EXPECT_TRUE(first->ask("1;1;CNTLON")->done);
  EXPECT_THAT(switch_on(*line(), {"1", std::nullopt}).problem.fact,
              HasSubstr("was refused, error 9200 (operation right is held elsewhere)"));
  EXPECT_TRUE(look_at_switches(*line(), {}).before->status.rights_taken());
}

TEST_F(SwitchesOnTheNetwork, CtrlCLeavesTheServosOffAndTheRightFree) {
  start({.on = false});
  std::atomic<int> looks{0};
  // While the servos come on: the line looks for it at every wait.
  const SwitchesReport report =
      switch_on(*line([&looks] { return ++looks > 12; }), {"1", std::nullopt});
  EXPECT_FALSE(report.done);
  const SwitchesReport after = look_at_switches(*line(), {});
  EXPECT_FALSE(after.before->status.servo_on());
  EXPECT_FALSE(after.before->status.rights_taken());
}

TEST_F(SwitchesOnTheNetwork, DoctorAndDevicesSayWhyTheArmIsSilent) {
  start({.on = false, .teach = true});
  MelfaDriver driver(robot(), false);
  const auto seen = driver.probe();
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].readiness, Readiness::kUnfinished);
  EXPECT_THAT(seen[0].fact, HasSubstr("the controller is in TEACH (manual)"));
  EXPECT_THAT(seen[0].next, HasSubstr("turn its key"));
  const auto test = driver.test({});
  ASSERT_FALSE(test);
  EXPECT_THAT(test.message(), HasSubstr("the controller is in TEACH (manual)"));
}

TEST_F(SwitchesOnTheNetwork, ATestOfTheArmSaysWhatItsSwitchesSay) {
  start({});
  MelfaDriver driver(robot(), false);
  auto test = driver.test({});
  ASSERT_TRUE(test) << test.message();
  const auto items = (*test)->items();
  ASSERT_FALSE(items.empty());
  EXPECT_EQ(items[0].check, "switches");
  EXPECT_EQ(items[0].verdict, Verdict::kOk);
  EXPECT_EQ(items[0].fact, "automatic, servos on, program '1' runs, override 100 %");
}

TEST_F(SwitchesOnTheNetwork, ManyConnectionsAndFloodsLeaveTheRigAtWork) {
  start({});
  std::vector<std::unique_ptr<R3Socket>> lines;
  for (int i = 0; i < SwitchesServer::kMostConnections; ++i) lines.push_back(line());
  for (const auto& one : lines) EXPECT_TRUE(look_at_switches(*one, {}).done);
  const auto one_more = line();
  EXPECT_THAT(one_more->ask("1;1;STATE").message(), HasSubstr("connection was closed"));
  const auto flood = lines[0]->ask(std::string(100'000, 'x'));
  EXPECT_TRUE(!flood || !flood->done);
  EXPECT_TRUE(answers());
}

// Somebody who is no controller, at a free port; tells `words` to who comes.
class Stranger {
 public:
  explicit Stranger(std::string words, bool closes = false) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&at), size), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size), 0);
    port = ntohs(at.sin_port);
    thread_ = std::thread([this, words = std::move(words), closes] {
      const int fd = ::accept(listener_, nullptr, nullptr);
      if (fd < 0) return;
      std::array<char, 64> heard{};
      EXPECT_GT(::recv(fd, heard.data(), heard.size(), 0), 0);
      EXPECT_EQ(::send(fd, words.data(), words.size(), MSG_NOSIGNAL),
                static_cast<ssize_t>(words.size()));
      if (!closes) (void)::recv(fd, heard.data(), heard.size(), 0);
      ::close(fd);
    });
  }
  ~Stranger() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  std::uint16_t port = 0;

 private:
  int listener_ = -1;
  std::thread thread_;
};

std::string complaint_of(const Stranger& stranger) {
  const auto line = R3Socket::connect("127.0.0.1", stranger.port);
  EXPECT_TRUE(line) << line.message();
  const auto answer = (*line)->ask("1;1;STATE");
  EXPECT_FALSE(answer);
  EXPECT_THAT(answer.message(), HasSubstr("127.0.0.1:" + std::to_string(stranger.port)));
  return answer.message();
}

TEST(R3Socket, NamesWhoIsNoController) {
  const Nanos begun = monotonic_now();
  EXPECT_THAT(complaint_of(Stranger("SSH-2.0-OpenSSH_9.2p1\r\n")),
              HasSubstr("'SSH-2.0-OpenSSH_9.2p1"));
  EXPECT_THAT(complaint_of(Stranger("")), HasSubstr("no answer to 1;1;STATE within 1 s"));
  EXPECT_THAT(complaint_of(Stranger("", true)), HasSubstr("the connection was closed"));
  EXPECT_THAT(complaint_of(Stranger(std::string(5000, 'x'))), HasSubstr("QoK or QeR"));
  EXPECT_LT(monotonic_now() - begun, 20 * kSecond);
  const auto nobody = R3Socket::connect("127.0.0.1", 1);
  ASSERT_FALSE(nobody);
  EXPECT_THAT(nobody.message(), HasSubstr("127.0.0.1:1: cannot be reached: Connection refused"));
  EXPECT_THAT(R3Socket::connect("localhost", 10001).message(), HasSubstr("expected an IPv4"));
}

}  // namespace
}  // namespace handrail
