#include "tests/unit/doctor/doctor_samples.h"

namespace handrail {
namespace {

using test::expect_found;
using test::found;
using test::healthy;
using test::says;
using test::status;

TEST(DoctorLink, SaysWhoIsThereAndWhatWasMeasured) {
  const DoctorFacts facts = healthy();
  expect_found(facts, "link.peer", Level::kOk,
               "session with cell, key 3f2a-91bc-07de-55a1, at 192.0.2.7:47002, for 5 min", "");
  // |2| + |2| + |0.5| + |7.5| over four.
  expect_found(
      facts, "link.round_trip", Level::kOk,
      "12.5 ms (median), 20.0 ms at worst, 3.0 ms from one to the next (jitter); 5 of them", "");
}

TEST(DoctorLink, AProblemOfTheSessionIsSplitIntoFactAndWhatToType) {
  DoctorFacts facts = healthy();
  pb::PeerStatus& peer = *status(facts).mutable_peer();
  peer.clear_name();
  peer.set_problem(
      "the slave at 192.0.2.7:47002 does not trust our key: on that computer, type: x");
  peer.set_next("on that computer, type: x");
  const Finding finding = found(facts, "link.peer");
  EXPECT_EQ(finding.level, Level::kProblem);
  EXPECT_EQ(finding.fact, "the slave at 192.0.2.7:47002 does not trust our key");
  EXPECT_EQ(finding.next, "on that computer, type: x");
  EXPECT_FALSE(says(facts, "link.loss")) << "of a link that is not there nothing is measured";
}

TEST(DoctorLink, NoSessionYetASilentOneAndOneThatCannotBeReadAreToldApart) {
  DoctorFacts facts = healthy();
  status(facts).clear_slave_program();
  status(facts).set_packet_age_ms(-1.0);
  expect_found(facts, "link.peer", Level::kProblem, "nothing that it says can be read",
               "handrail --version, on both computers");
  status(facts).set_packet_age_ms(201.0);
  *status(facts).mutable_slave_program() = test::sample_program();
  expect_found(facts, "link.peer", Level::kProblem, "last heard 0 s ago", "the network between");
  status(facts).set_packet_age_ms(3200.0);
  expect_found(facts, "link.peer", Level::kProblem, "last heard 3 s ago, expected within 20 ms",
               "the network between");
  status(facts).mutable_peer()->clear_name();
  expect_found(facts, "link.peer", Level::kProblem, "no session yet with the slave at arm.example",
               "look again");
  status(facts).mutable_peer()->set_encrypted(false);
  status(facts).set_packet_age_ms(-1.0);
  expect_found(facts, "link.peer", Level::kProblem, "no slave has answered at arm.example",
               "handrail-slave");
}

TEST(DoctorLink, ASceneOfWallsNeedsNoSlave) {
  DoctorFacts facts = healthy();
  status(facts).clear_slave_program();
  status(facts).mutable_walls()->set_stage(0);
  expect_found(facts, "link.peer", Level::kOk, "no slave takes part", "");
}

TEST(DoctorLink, LossAndGapsAreHeldAgainstWhatAnEngageAsks) {
  struct Case {
    double here, there;
    Level level;
  };
  for (const Case& c : {Case{0.0, 0.01, Level::kOk}, Case{0.0, 0.02, Level::kNote},
                        Case{0.02, 0.0, Level::kNote}, Case{0.25, 0.25, Level::kNote},
                        Case{0.0, 0.26, Level::kProblem}, Case{0.26, 0.0, Level::kProblem}}) {
    DoctorFacts facts = healthy();
    pb::LinkGate& gate = *status(facts).mutable_gate();
    gate.set_lost_share(c.here);
    gate.set_peer_lost_share(c.there);
    EXPECT_EQ(found(facts, "link.loss").level, c.level) << c.here << " " << c.there;
    gate.set_window_s(0.0);
    EXPECT_NE(found(facts, "link.loss").level, Level::kProblem) << "nothing is asked";
  }
  for (const Case& c :
       {Case{0.005, 0.0, Level::kOk}, Case{0.09, 0.0, Level::kNote}, Case{0.0, 0.05, Level::kNote},
        Case{0.1, 0.0, Level::kProblem}, Case{0.0, 0.1, Level::kProblem}}) {
    DoctorFacts facts = healthy();
    status(facts).mutable_gate()->set_held_share(c.here);
    status(facts).mutable_gate()->set_peer_held_share(c.there);
    EXPECT_EQ(found(facts, "link.gaps").level, c.level) << c.here << " " << c.there;
  }
  DoctorFacts facts = healthy();
  status(facts).mutable_gate()->set_peer_lost_share(0.3);
  expect_found(facts, "link.loss", Level::kProblem,
               "0.0 % here, 30.0 % at the slave; at most 25 % in 1 s is asked", "cable");
}

TEST(DoctorLink, GapsAreAProblemAndALinkThatIsYoungIsNone) {
  DoctorFacts facts = healthy();
  EXPECT_FALSE(says(facts, "link.heard"));
  status(facts).mutable_gate()->set_heard_share(0.4);
  expect_found(facts, "link.heard", Level::kProblem, "for 0.40 s without a gap of over 200 ms; 1 s",
               "cable");
  status(facts).mutable_gate()->set_heard_share(0.95);
  expect_found(facts, "link.heard", Level::kNote, "for 0.95 s", "look again");
  status(facts).mutable_gate()->set_window_s(10.0);
  status(facts).mutable_gate()->set_heard_share(0.1);
  expect_found(facts, "link.heard", Level::kNote, "for 1.00 s", "look again");
}

TEST(DoctorLink, AnOldLoopIsSaidWithBothItsLimits) {
  DoctorFacts facts = healthy();
  facts.master.loop_ages_ms = {90.0, 99.0};
  expect_found(facts, "link.loop", Level::kOk, "99.0 ms old at worst; over 100 ms it is said", "");
  facts.master.loop_ages_ms.push_back(101.0);
  expect_found(facts, "link.loop", Level::kNote, "101.0 ms old", "move slower");
  facts.master.loop_ages_ms.push_back(601.0);
  expect_found(facts, "link.loop", Level::kProblem, "over 600 ms the force fades", "loop_limit_ms");
}

TEST(DoctorLink, QualityOfEitherSideCounts) {
  for (const bool here : {false, true}) {
    DoctorFacts facts = healthy();
    const auto set = [&](const char* grade) {
      here ? status(facts).set_link_quality(grade) : status(facts).set_peer_quality(grade);
    };
    set("FAIR");
    expect_found(facts, "link.quality", Level::kNote, "FAIR", "cable");
    set("POOR");
    expect_found(facts, "link.quality", Level::kProblem, "the arm holds while one is POOR",
                 "cable");
  }
}

TEST(DoctorRoute, NamesTheInterfaceAndTheTunnelUnderTheLink) {
  DoctorFacts facts = healthy();
  EXPECT_EQ(found(facts, "route.way").fact, "the way to 192.0.2.7:47002 goes through eth0");
  facts.route->interface = "wg0";
  facts.route->tunnel = Tunnel::kWireGuard;
  expect_found(facts, "route.way", Level::kOk, "through wg0, which is WireGuard", "");
  facts.route->tunnel = Tunnel::kTailscale;
  expect_found(facts, "route.way", Level::kOk, "which is Tailscale", "");
  facts.route->problem = "Network is unreachable";
  expect_found(facts, "route.way", Level::kProblem, "no way to 192.0.2.7:47002: Network is",
               "ip route get 192.0.2.7   ");
  facts.route.reset();
  EXPECT_FALSE(says(facts, "route.way"));
}

// 613 + 8 + 20 and 1232 + 8 + 20 with IPv4, 20 more with IPv6.
TEST(DoctorRoute, ADatagramMustGoThroughWhole) {
  DoctorFacts facts = healthy();
  facts.route->mtu = 1260;
  expect_found(facts, "route.mtu", Level::kOk, "a datagram of the link has 641 at most", "");
  facts.route->mtu = 1259;
  expect_found(facts, "route.mtu", Level::kProblem, "handshakes are cut in pieces",
               "ip link set eth0 mtu 1280");
  facts.route->mtu = 640;
  expect_found(facts, "route.mtu", Level::kProblem, "every datagram is cut in pieces", "mtu 1280");
  facts.route->v6 = true;
  facts.route->mtu = 1280;
  expect_found(facts, "route.mtu", Level::kOk, "a datagram of the link has 661 at most", "");
  facts.route->mtu = 1279;
  expect_found(facts, "route.mtu", Level::kProblem, "one of its handshake 1280", "mtu 1280");
  facts.route->mtu = 0;
  EXPECT_FALSE(says(facts, "route.mtu")) << "not known";
}

}  // namespace
}  // namespace handrail
