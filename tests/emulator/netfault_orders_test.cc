// Orders while real programs talk: the network changes at a moment, and strangers speak.
#include "tests/emulator/netfault_bench.h"
#include "tests/emulator/network.h"
#include "tests/emulator/tap.h"
#include "tests/unit/emulator/packet_samples.h"

namespace handrail::emulator {
namespace {

class NetfaultOrdersTest : public NetfaultTest {
 protected:
  // Far serves until the test ends it.
  Words serving(const Words& options = {}) const {
    return options + served() + Words{"--orders", socket_, "--", "far:", kEcho, "serve", "7000"};
  }
  std::string ping(int count, int wait_ms = 100) const {
    return std::string(kEcho) + " ping 10.77.0.2 7000 " + std::to_string(count) + " 1000 " +
           std::to_string(wait_ms);
  }
  const std::string socket_ = folder_.path() + "/orders";
};

TEST_F(NetfaultOrdersTest, AnOutageBeginsAndEndsWhileTheyTalk) {
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  ASSERT_EQ(desk.order("run near first " + ping(100)), "ok");
  ASSERT_TRUE(prints("near-first", "sent=100 answered=100"));
  ASSERT_EQ(desk.order("change to_far { loss: 1 }"), "ok");
  ASSERT_EQ(desk.order("run near second " + ping(100)), "ok");
  ASSERT_TRUE(prints("near-second", "sent=100 answered=0"));
  ASSERT_EQ(desk.order("change to_far { loss: 0 } outage { for_s: 0.05 }"), "ok");
  ASSERT_EQ(desk.order("run near third " + ping(400)), "ok");
  ASSERT_TRUE(prints("near-third", "TRIPS"));
  const double answered = figure(printed("near-third"), "answered=");
  EXPECT_GE(answered, 340.0) << printed("near-third");
  const std::string report = desk.order("report");
  EXPECT_EQ(count(report, "to_far", "lost"), 100.0) << report;
  EXPECT_EQ(count(report, "to_far", "dark"), 400.0 - answered) << report;
  EXPECT_EQ(desk.order("end"), "ok");
  EXPECT_EQ(netfault.finish(), 0) << netfault.output();
}

TEST_F(NetfaultOrdersTest, RoamingAndRebindingAreSeenByTheOtherSide) {
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  EXPECT_EQ(desk.order("rebind"), "error: rebind: the network has no nat");
  ASSERT_EQ(desk.order("run near talk " + ping(20'000)), "ok");
  ASSERT_TRUE(prints("far-main", "FROM ::ffff:10.77.0.1 "));
  EXPECT_EQ(desk.order("roam"), "ok");
  ASSERT_TRUE(prints("far-main", "FROM ::ffff:10.77.1.1 "));
  EXPECT_EQ(desk.order("change edge { nat: true }"), "ok");
  ASSERT_TRUE(prints("far-main", "FROM ::ffff:10.77.2.1 "));
  EXPECT_EQ(desk.order("rebind"), "ok");
  const std::string start = "FROM ::ffff:10.77.2.1 ";
  const auto ports = [&] {
    std::string text = printed("far-main");
    int found = 0;
    for (std::size_t i = 0; (i = text.find(start, i)) != std::string::npos; ++i) ++found;
    return found;
  };
  const Nanos give_up = monotonic_now() + Program::kPatience;
  while (ports() < 2 && monotonic_now() < give_up) sleep_until(monotonic_now() + kMillisecond);
  EXPECT_EQ(ports(), 2) << printed("far-main");
  // Answers come back through the newest port.
  const double before = count(desk.order("report"), "to_near", "delivered");
  desk.report_with("to_near", "delivered", before + 50);
}

TEST_F(NetfaultOrdersTest, SignalsReachAProgramByItsName) {
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  ASSERT_EQ(desk.order("signal far main STOP"), "ok");
  ASSERT_EQ(desk.order("run near stopped " + ping(50)), "ok");
  ASSERT_TRUE(prints("near-stopped", "sent=50 answered=0"));
  ASSERT_EQ(desk.order("signal far main CONT"), "ok");
  ASSERT_EQ(desk.order("run near again " + ping(50)), "ok");
  ASSERT_TRUE(prints("near-again", "sent=50 answered=50"));
  EXPECT_EQ(desk.order("signal far main BANG"),
            "error: SIGNAL 'BANG': expected a name such as KILL or STOP");
  EXPECT_EQ(desk.order("signal far other KILL"), "error: 'other': no such program runs there");
  ASSERT_EQ(desk.order("signal far main KILL"), "ok");
  EXPECT_EQ(netfault.finish(), 1) << netfault.output();
  EXPECT_NE(netfault.output().find("far: signal 9"), std::string::npos) << netfault.output();
}

TEST_F(NetfaultOrdersTest, AStrangersDatagramHasTheSourceAndTheBytesItWasGiven) {
  Program netfault(folder_, "handrail-netfault", serving({"--tap", folder_.path()}));
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  EXPECT_EQ(desk.order("inject far 192.0.2.9:4321 10.77.0.2:7000 00ff10"), "ok");
  ASSERT_TRUE(prints("far-main", "FROM ::ffff:192.0.2.9 4321"));
  EXPECT_EQ(desk.order("inject far [2001:db8::9]:1234 [fd77::2]:7000 aa"), "ok");
  ASSERT_TRUE(prints("far-main", "FROM 2001:db8::9 1234"));
  ASSERT_EQ(desk.order("end"), "ok");
  ASSERT_EQ(netfault.finish(), 0);
  const auto records = read_tap(folder_.path() + "/far.pcap");
  ASSERT_TRUE(records.is_ok()) << records.message();
  ASSERT_GE(records->size(), 2u);
  const auto payload = std::vector<std::uint8_t>{0x00, 0xff, 0x10};
  EXPECT_EQ((*records)[0].packet, make_udp(at("192.0.2.9:4321"), at("10.77.0.2:7000"), payload));
  EXPECT_EQ((*records)[0].origin, Origin::kInjected);
  EXPECT_FALSE((*records)[0].sent);
}

// Each side's tap is the other's but for what the network did.
TEST_F(NetfaultOrdersTest, TapsTellWhatWasSentAndWhatCameOfIt) {
  const std::string report =
      run(echo_and_ping({"--tap", folder_.path(), "--set", "to_far { loss: 0.2 corrupt: 0.2 }"},
                        "10.77.0.2 7000 300 1000 100"));
  const auto near = read_tap(folder_.path() + "/near.pcap");
  const auto far = read_tap(folder_.path() + "/far.pcap");
  ASSERT_TRUE(near && far);
  std::vector<const TapRecord*> sent;
  for (const TapRecord& record : *near) {
    if (record.sent) sent.push_back(&record);
  }
  EXPECT_EQ(static_cast<double>(sent.size()), count(report, "to_far", "sent"));
  int delivered = 0, corrupted = 0;
  for (const TapRecord& record : *far) {
    if (record.sent) continue;
    ASSERT_GE(record.number, 1u);
    ASSERT_LE(record.number, sent.size());
    const TapRecord& from = *sent[record.number - 1];
    EXPECT_GE(record.at, from.at);
    const bool same = record.packet == from.packet;
    EXPECT_EQ(same, record.origin == Origin::kGenuine);
    ++delivered;
    corrupted += !same;
  }
  EXPECT_EQ(delivered, count(report, "to_far", "delivered")) << report;
  EXPECT_EQ(corrupted, count(report, "to_far", "corrupted")) << report;
}

TEST_F(NetfaultOrdersTest, AnEarlierSessionIsReplayedAndReflected) {
  run(echo_and_ping({"--tap", folder_.path()}, "10.77.0.2 7000 200 1000 100"));
  const std::string earlier = folder_.path() + "/far.pcap";
  std::filesystem::remove(folder_.path() + "/far-main.out");
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  ASSERT_EQ(desk.order("replay far " + earlier + " 2000"), "ok");
  const std::string replayed = desk.report_with("to_far", "injected", 200);
  EXPECT_EQ(count(replayed, "to_far", "injected"), 200.0);
  // The server takes them for near's, and answers.
  desk.report_with("to_near", "sent", 200);
  // What far answered, turned around: from near's port to far's.
  ASSERT_EQ(desk.order("reflect far " + earlier + " 2000"), "ok");
  desk.report_with("to_far", "injected", 400);
  desk.report_with("to_near", "sent", 400);
  EXPECT_EQ(desk.order("replay far /nowhere 1"),
            "error: /nowhere: cannot read: No such file or directory");
}

TEST_F(NetfaultOrdersTest, AHundredThousandDatagramsASecondOfJunkArrive) {
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  ASSERT_TRUE(prints("far-main", "SERVES"));
  ASSERT_EQ(desk.order("run near talk " + ping(500, 500)), "ok");
  ASSERT_TRUE(prints("far-main", "FROM ::ffff:10.77.0.1"));
  const Nanos begun = monotonic_now();
  ASSERT_EQ(desk.order("flood far 192.0.2.9:1 10.77.0.2:7001 100000 1 200"), "ok");
  const std::string report = desk.report_with("to_far", "injected", 100'000);
  const double took = to_seconds(monotonic_now() - begun);
  ASSERT_TRUE(prints("near-talk", "TRIPS"));
  std::printf("100000 datagrams in %.2f s, beside them: %s", took, printed("near-talk").c_str());
  EXPECT_EQ(count(report, "to_far", "injected"), 100'000.0);
  EXPECT_EQ(count(report, "to_far", "overflow"), 0.0) << report;
  EXPECT_EQ(figure(report, "\"refused\":"), 0.0) << report;
  EXPECT_GE(took, 0.95);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(took, 1.5);
#endif
}

TEST_F(NetfaultOrdersTest, WrongOrdersAreAnsweredWithPlaceValueAndWhatWasExpected) {
  Program netfault(folder_, "handrail-netfault", serving());
  Orderer desk(socket_);
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"stop",
       "'stop': expected network, change, roam, rebind, run, signal, inject, flood, "
       "replay, reflect, report or end"},
      {"network 3-kHz",
       "'3-kHz': neither a file nor a network's name; the names are clear, far, "
       "bursts, netcode, harsh, narrow"},
      {"change to_far { loss: 2 }", "change:1:10: field 'to_far.loss': 2 is outside 0 to 1"},
      {"run up x true", "side 'up': expected near or far"},
      {"run near x", "LINE: missing"},
      {"run near a/b true", "NAME 'a/b': has a '/'"},
      {"run far main true", "'main' has run already"},
      {"inject far 1.2.3.4:1 [fd77::2]:1 00", "FROM and TO: one is IPv4 and the other IPv6"},
      {"inject far 1.2.3.4 10.77.0.2:1 00",
       "FROM '1.2.3.4': expected address and port, such as 10.77.0.1:5000 or [fd77::1]:5000"},
      {"inject far 1.2.3.4:1 10.77.0.2:1 0g", "HEX: '0g' at digit 1"},
      {"inject far 1.2.3.4:1 10.77.0.2:1 012", "HEX: 3 digits, expected an even number up to 2904"},
      {"flood far 1.2.3.4:1 10.77.0.2:1 0 1 1",
       "PER_SECOND '0': expected a number from 1 to 1000000"},
      {"flood far 1.2.3.4:1 10.77.0.2:1 1 1 9999",
       "BYTES '9999': expected a number from 0 to 1452"},
  };
  for (const auto& [order, answer] : wrong) EXPECT_EQ(desk.order(order), "error: " + answer);
  // One that does not end its line, or goes, keeps nobody else from ordering.
  Orderer other(socket_);
  EXPECT_EQ(other.order("network netcode"), "ok");
  EXPECT_EQ(desk.order("end"), "ok");
  EXPECT_EQ(netfault.finish(), 0) << netfault.output();
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

}  // namespace
}  // namespace handrail::emulator
