// Strangers' bytes on every socket and port of the three programs, some of which pass all checks
// but one.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <utility>

#include "devices/melfa/mxt_packet.h"
#include "devices/net_ft/rdt_packet.h"
#include "tests/loopback/raw_client.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/bad_datagrams.h"
#include "tests/support/datagram_relay.h"

namespace handrail {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;

// Between two datagrams, so that no queue overflows.
constexpr Nanos kPause = 200 * kMicrosecond;

// Why datagrams were dropped, and how many of them.
using Causes = std::map<Reject, std::uint64_t>;

// Every way between two of the programs leads past the test.
class GarbageTest : public WholeCell {
 protected:
  GarbageTest() {
    header.session = 0x5eed;
    header.sequence = 1;
    header.sent = kSecond;
    to_slave =
        test::bad_datagrams<pb::MasterDatagram>(header, MasterState(), DatagramKind::kMaster);
    to_master = test::bad_datagrams<pb::SlaveDatagram>(header, SlaveState(), DatagramKind::kSlave);
  }

  void SetUp() override {
    start_rig();
    robot = std::make_unique<UdpRelay>(robot_port);
    sensor = std::make_unique<UdpRelay>(sensor_port);
    slave_through_relays();
    link = std::make_unique<LinkRelay>(link_socket);
    master_through_relay();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
  void slave_through_relays() {
    const auto own = std::pair(robot_port, sensor_port);
    std::tie(robot_port, sensor_port) = std::pair(robot->port(), sensor->port());
    start_slave();
    std::tie(robot_port, sensor_port) = own;
  }
  void master_through_relay() {
    const std::string own = std::exchange(link_socket, link->path());
    start_master();
    master_at = DatagramPlace(master_place(*master));
    link_socket = own;
  }
  static bool fresh(const pb::Status& s) {
    return s.has_tip() && s.packet_age_ms() >= 0.0 && s.packet_age_ms() < 20.0;
  }

  // As if the slave had said it, or the master.
  void say_to_master(Reject cause, const Bytes& bytes) {
    sent_to_master[cause] += link->to_client(bytes) ? 1 : 0;
    sleep_until(monotonic_now() + kPause);
  }
  void say_to_slave(Reject cause, const Bytes& bytes) {
    sent_to_slave[cause] += stranger_of_link.send(slave_at, bytes) ? 1 : 0;
    sleep_until(monotonic_now() + kPause);
  }
  void say_as_stranger(int port, const Bytes& bytes) {
    (void)stranger.send(DatagramPlace(port), bytes);
    sleep_until(monotonic_now() + kPause);
  }
  bool eventually_engages() {
    return eventually([this](const pb::Status&) { return ask("engage: true").done(); });
  }
  std::uint64_t session_of_master() const {
    Codec codec;
    DatagramHeader h;
    MasterState state;
    const auto seen = link->seen(true);
    EXPECT_EQ(seen.empty() ? Reject::kSize : codec.decode(seen.back(), h, state), Reject::kNone);
    return h.session;
  }

  // What a program that was told to end says of its link.
  static Causes causes_of(Program& program) {
    program.send(SIGTERM);
    EXPECT_EQ(program.finish(), 0) << program.output();
    const std::string said = program.after("datagrams accepted, ");
    Causes out;
    for (std::size_t i = 1; i < kRejectCauses; ++i) {
      const auto cause = static_cast<Reject>(i);
      const std::string text = std::string(describe(cause)) + " ";
      const std::size_t at = said.find(text);
      if (at != std::string::npos) out[cause] = std::stoull(said.substr(at + text.size()));
    }
    return out;
  }
  // All that was sent failed the check it was to fail, but for what waited while the program did
  // not run.
  static void expect_counted(const Causes& sent, Causes counted) {
    for (const auto& [cause, number] : sent) {
      EXPECT_GE(counted[cause] + counted[Reject::kAfterStall], number) << describe(cause);
      EXPECT_GT(counted[cause], 0u) << describe(cause);
    }
  }

  Bytes noise() {
    Bytes out(dice() % 2000);
    for (auto& byte : out) byte = static_cast<std::uint8_t>(dice());
    return out;
  }

  std::unique_ptr<UdpRelay> robot, sensor;
  std::unique_ptr<LinkRelay> link;
  PlacedSocket stranger{DatagramPlace(0)};
  PlacedSocket stranger_of_link{DatagramPlace(folder.path() + "/stranger")};
  DatagramPlace slave_at{link_socket}, master_at;
  DatagramHeader header;
  std::vector<test::BadDatagram> to_slave, to_master;
  Causes sent_to_slave, sent_to_master;
  std::mt19937_64 dice{7};
};

TEST_F(GarbageTest, EachDatagramFailsItsOwnCheckAndNoneIsLeftOut) {
  std::map<Reject, int> seen;
  Codec codec;
  DatagramHeader h;
  MasterState master_state;
  SlaveState slave_state;
  Refusal refusal;
  for (const auto& bad : to_slave) {
    EXPECT_EQ(codec.decode(bad.bytes, h, master_state), bad.cause) << describe(bad.cause);
    ++seen[bad.cause];
  }
  for (const auto& bad : to_master) {
    EXPECT_EQ(codec.decode(bad.bytes, h, slave_state), bad.cause) << describe(bad.cause);
    ++seen[bad.cause];
  }
  for (const auto& bad : test::bad_refusals(1)) {
    const Reject cause = bad.cause == Reject::kStale ? Reject::kNone : bad.cause;
    EXPECT_EQ(codec.decode(bad.bytes, refusal), cause) << describe(bad.cause);
  }
  for (int i = 1; i <= static_cast<int>(Reject::kScene); ++i) {
    const auto cause = static_cast<Reject>(i);
    EXPECT_GT(seen[cause], 0) << describe(cause);
  }
}

TEST_F(GarbageTest, OnTheLinkEachCheckCountsItAndNothingChanges) {
  order("engage: true");
  const pb::Status before = at_rest();
  const auto refusals = test::bad_refusals(session_of_master());
  const Bytes other_slave = test::sound_datagram(header, SlaveState());
  const Bytes other_master = test::sound_datagram(header, MasterState());
  for (int i = 0; i < 20; ++i) {
    for (const auto& bad : to_master) {
      say_to_master(bad.cause, bad.bytes);
      sent_to_master[Reject::kSender] += stranger_of_link.send(master_at, bad.bytes) ? 1 : 0;
    }
    for (const auto& bad : refusals) say_to_master(bad.cause, bad.bytes);
    for (const auto& bad : to_slave) say_to_slave(bad.cause, bad.bytes);
    // What the other side has just said, and what it said 400 datagrams ago, which
    // is more than it remembers.
    say_to_master(Reject::kDuplicate, link->seen(false).back());
    say_to_master(Reject::kStale, link->seen(false).front());
    say_to_slave(Reject::kDuplicate, link->seen(true).back());
    say_to_slave(Reject::kStale, link->seen(true).front());
    say_to_master(Reject::kSessionBusy, other_slave);
    say_to_slave(Reject::kSessionBusy, other_master);
    (void)link->to_client(noise());
    for (const DatagramPlace& to : {master_at, slave_at}) (void)stranger_of_link.send(to, noise());
    sleep_until(monotonic_now() + kPause);
  }
  EXPECT_TRUE(reaches("engaged"));
  EXPECT_TRUE(slave_reaches("engaged"));
  EXPECT_LT((mm(at_rest().slave_command()) - mm(before.slave_command())).norm(), 0.01);
  order("disengage: true");
  expect_counted(sent_to_slave, causes_of(*slave));
  expect_counted(sent_to_master, causes_of(*master));
}

// A recording of a session that is over, what waited while a program stood still, and a refusal.
TEST_F(GarbageTest, OnTheLinkNoOldSessionComesBack) {
  const Bytes old_master = link->seen(true).back();
  master->kill();
  client.close();
  master_through_relay();
  ASSERT_TRUE(eventually(fresh));
  // The slave keeps to the old session until that has been silent for long enough.
  ASSERT_TRUE(eventually_engages());
  ASSERT_TRUE(slave_reaches("engaged"));
  order("disengage: true");
  for (int i = 0; i < 20; ++i) say_to_slave(Reject::kSessionRetired, old_master);
  slave->send(SIGSTOP);
  sleep_until(monotonic_now() + 50 * kMillisecond);
  for (int i = 0; i < 100; ++i) say_to_slave(Reject::kAfterStall, to_slave[0].bytes);
  slave->send(SIGCONT);
  ASSERT_TRUE(eventually(fresh));
  const Bytes old_slave = link->seen(false).back();
  expect_counted(sent_to_slave, causes_of(*slave));

  slave_through_relays();
  ASSERT_TRUE(eventually(fresh));
  for (int i = 0; i < 20; ++i) say_to_master(Reject::kSessionRetired, old_slave);
  master->send(SIGSTOP);
  sleep_until(monotonic_now() + 50 * kMillisecond);
  for (int i = 0; i < 100; ++i) say_to_master(Reject::kAfterStall, to_master[0].bytes);
  master->send(SIGCONT);
  ASSERT_TRUE(eventually(fresh));
  Bytes refusal(kMaxDatagram);
  refusal.resize(Codec().encode(
      Refusal{session_of_master(), false, fixed_text<LeaderName>("eve"), kSecond}, refusal));
  say_to_master(Reject::kRefused, refusal);
  ASSERT_TRUE(eventually_engages()) << "it stands until the slave's next word";
  ASSERT_TRUE(slave_reaches("engaged"));
  order("disengage: true");
  expect_counted(sent_to_master, causes_of(*master));
}

// From the controller's and the sensor's own ports, where the slave listens to nobody else.
TEST_F(GarbageTest, FromRobotAndSensorItChangesNothing) {
  order("engage: true");
  const pb::Status before = at_rest();
  std::uint64_t to_robot = 0, to_sensor = 0;
  const auto say = [&](UdpRelay& way, std::uint64_t& count, const Bytes& bytes) {
    (void)way.to_client(bytes);
    say_as_stranger(way.client().port(), bytes);
    ++count;
  };
  for (int i = 0; i < 20; ++i) {
    for (const std::size_t size : {kMxtShort, kMxtLong}) {
      MxtPacket packet;
      packet.send_type = packet.type[0] = MxtType::kFeedbackJoint;
      packet.block[0].set_real(0, std::nan(""));
      std::array<std::uint8_t, kMxtLong> buffer{};
      const auto endless = encode_mxt(packet, size, buffer);
      say(*robot, to_robot, Bytes(endless.begin(), endless.end()));
      say(*robot, to_robot, Bytes(endless.begin(), endless.end() - 1));
      packet.block[0].set_real(0, 0.0);
      packet.type[0] = MxtType::kPose;  // not what it says it sends
      const auto two_types = encode_mxt(packet, size, buffer);
      say(*robot, to_robot, Bytes(two_types.begin(), two_types.end()));
      packet.type[0] = MxtType{99};  // not any
      const auto no_type = encode_mxt(packet, size, buffer);
      say(*robot, to_robot, Bytes(no_type.begin(), no_type.end()));
      packet.send_type = packet.type[0] = MxtType{99};
      const auto no_kind = encode_mxt(packet, size, buffer);
      say(*robot, to_robot, Bytes(no_kind.begin(), no_kind.end()));
    }
    say(*robot, to_robot, noise());
    say(*sensor, to_sensor, noise());
    say(*sensor, to_sensor, Bytes(kRdtRecordSize - 1));
    say(*sensor, to_sensor, Bytes(kRdtRecordSize + 1));
    (void)sensor->to_client(sensor->seen(false).front());
  }
  EXPECT_EQ(at_rest().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
  EXPECT_LT((mm(at_rest().slave_command()) - mm(before.slave_command())).norm(), 0.01);
  EXPECT_EQ(move_hand("0, 5, 0").state(), "engaged");
  order("disengage: true");
  slave->send(SIGTERM);
  EXPECT_EQ(slave->finish(), 0);
  // A socket holds some ten packets of the controller while its thread does not run.
  const auto rejected = [this](const std::string& by) {
    return static_cast<std::uint64_t>(
        std::atoi(slave->after(by).substr(slave->after(by).find("taken, ") + 7).c_str()));
  };
  EXPECT_GT(rejected("controller: "), to_robot / 2);
  EXPECT_LE(rejected("controller: "), to_robot) << "a stranger was heard";
  EXPECT_GT(rejected("force sensor: "), to_sensor / 2);
  EXPECT_LE(rejected("force sensor: "), to_sensor) << "a stranger was heard";
}

// A stranger who speaks the controller's and the sensor's protocol without a fault is served as a
// PC is. Anything else changes nothing.
TEST_F(GarbageTest, AtTheRigItStopsNeitherArmNorSensor) {
  order("engage: true");
  for (int i = 0; i < 20; ++i) {
    for (const std::size_t size : {kMxtShort, kMxtLong}) {
      MxtPacket packet;
      packet.command = MxtCommand::kMove;
      packet.send_type = packet.type[0] = MxtType::kJoint;
      packet.block[0].set_real(0, std::nan(""));
      std::array<std::uint8_t, kMxtLong> buffer{};
      const auto move = encode_mxt(packet, size, buffer);
      say_as_stranger(robot_port, Bytes(move.begin(), move.end()));
      packet.command = static_cast<MxtCommand>(77);
      const auto other = encode_mxt(packet, size, buffer);
      say_as_stranger(robot_port, Bytes(other.begin(), other.end()));
      say_as_stranger(robot_port, Bytes(other.begin(), other.end() - 1));
    }
    say_as_stranger(robot_port, noise());
    say_as_stranger(sensor_port, noise());
    say_as_stranger(sensor_port, {0x12, 0x34, 0xff, 0xff, 0, 0, 0, 0});  // no command of RDT
    say_as_stranger(sensor_port, {0x12, 0x35, 0, 0, 0, 0, 0, 0});  // stop, with another header
  }
  const pb::Status after = at_rest();
  EXPECT_EQ(after.state(), "engaged");
  EXPECT_TRUE(after.has_contact_force());
  EXPECT_EQ(move_hand("0, 5, 0").state(), "engaged");
  EXPECT_TRUE(rig->running());
}

TEST_F(GarbageTest, OnTheOperatorsSocketItCostsItsSenderTheConnection) {
  // The answers until the connection is closed.
  const auto say = [&](const std::string& bytes) {
    RawClient raw(socket());
    EXPECT_TRUE(raw.send(bytes) || bytes.empty());
    raw.end();
    std::vector<std::string> answers;
    do answers.push_back(raw.receive().reason());
    while (answers.back() != "(closed)");
    answers.pop_back();
    return answers;
  };
  using Answers = std::vector<std::string>;
  pb::Request named, unknown, stranger_to_us;
  named.set_as("eve");
  unknown.GetReflection()->MutableUnknownFields(&unknown)->AddVarint(999, 1);
  stranger_to_us.set_engage(false);
  order("engage: true");
  for (int i = 0; i < 50; ++i) {
    const Bytes bytes = noise();
    const std::string text(bytes.begin(), bytes.end());
    (void)say(text);
    (void)say(framed(text));  // chance decides
    EXPECT_EQ(say(framed("\xff\xff")), Answers{"the request is garbled"});
    EXPECT_EQ(say(framed(text).substr(0, kFrameHeader)), Answers{});  // not to its end
    EXPECT_EQ(say(std::string(4, '\xff')),
              Answers{"a request of 4294967295 bytes, expected at most 65536"});
    for (const pb::Request& none : {pb::Request(), named, unknown, stranger_to_us}) {
      EXPECT_EQ(say(framed(none.SerializeAsString())), Answers{"the request holds no order"});
    }
  }
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
  EXPECT_TRUE(master->running());
}

}  // namespace
}  // namespace handrail
