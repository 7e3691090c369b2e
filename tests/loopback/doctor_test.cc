// handrail doctor beside real daemons: what it finds, what to type, and that it disturbs nothing.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "proto/doctor.pb.h"
#include "server/keys/key_folder.h"
#include "server/link/codec.h"
#include "tests/loopback/secure_cell.h"
#include "tests/support/bad_datagrams.h"
#include "tests/support/datagram_relay.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using Level = pb::DoctorFinding;

// What `handrail doctor --json` printed.
pb::DoctorReport report_of(const std::pair<int, std::string>& run) {
  const auto& [code, text] = run;
  pb::DoctorReport out;
  const auto read = google::protobuf::util::JsonStringToMessage(text, &out);
  EXPECT_TRUE(read.ok()) << text;
  EXPECT_EQ(code, out.problems() == 0 ? 0 : 1) << text;
  return out;
}

const pb::DoctorFinding& finding(const pb::DoctorReport& report, const std::string& check) {
  for (const pb::DoctorFinding& one : report.findings()) {
    if (one.check() == check) return one;
  }
  ADD_FAILURE() << "no " << check << " in " << report.DebugString();
  return pb::DoctorFinding::default_instance();
}

void expect_found(const pb::DoctorReport& report, const std::string& check, Level::Level level,
                  const std::string& fact, const std::string& next) {
  const pb::DoctorFinding& one = finding(report, check);
  EXPECT_EQ(one.level(), level) << report.DebugString();
  EXPECT_THAT(one.fact(), HasSubstr(fact));
  EXPECT_THAT(one.next(), HasSubstr(next));
}

class DoctorBesideACell : public WholeCell {
 protected:
  void TearDown() override { ::unsetenv("HANDRAIL_KEYS"); }
  pb::DoctorReport examined() {
    ::setenv("HANDRAIL_KEYS", (folder.path() + "/no-keys").c_str(), 1);
    return report_of(handrail({"doctor", "--json"}));
  }
};

TEST_F(DoctorBesideACell, SaysWhatIsThereWhileTheArmIsEngagedAndLeavesItSo) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  const pb::Status before = at_rest();
  const pb::DoctorReport report = examined();
  EXPECT_TRUE(slave_reaches("engaged"));
  EXPECT_LT((mm(at_rest().tip()) - mm(before.tip())).norm(), 0.1);
  expect_found(report, "programs.slave_version", Level::OK, status().slave_program().version(), "");
  expect_found(report, "link.peer", Level::OK, "plain link on this computer, at " + link_socket,
               "");
  expect_found(report, "link.round_trip", Level::OK, "(median)", "");
  expect_found(report, "scene.same", Level::OK, "linear-movement", "");
  expect_found(report, "keys.own", Level::NOTE, "no key in " + folder.path(), "handrail keys new");
  expect_found(report, "clock.calendar", Level::OK, "s apart", "");
  EXPECT_THAT(finding(report, "realtime.slave").fact(), HasSubstr("robot thread"));
  EXPECT_THAT(finding(report, "programs.slave").fact(), HasSubstr(std::to_string(slave->pid())));
}

TEST_F(DoctorBesideACell, WithoutASlaveAndWithoutAMasterItSaysSoAndWhatToStart) {
  slave->kill();
  sleep_until(monotonic_now() + 300 * kMillisecond);
  expect_found(examined(), "link.peer", Level::PROBLEM, "the slave was last heard",
               "whether the slave still runs");
  master->kill();
  start_master();
  expect_found(examined(), "link.peer", Level::PROBLEM, "no slave has answered at " + link_socket,
               "handrail-slave");
  master->kill();
  const pb::DoctorReport report = examined();
  EXPECT_THAT(finding(report, "programs.master").fact(), HasSubstr(socket()));
  EXPECT_NE(finding(report, "keys.own").fact(), "");
  EXPECT_NE(finding(report, "realtime.shell").fact(), "");
}

// One of another wire version, in the slave's place: each side is told, and doctor has both values.
TEST_F(DoctorBesideACell, ASlaveOfAnotherWireVersionIsNamedInDoctorStatusAndLog) {
  slave->send(SIGTERM);
  (void)slave->finish();
  PlacedSocket other{DatagramPlace(link_socket)};
  ASSERT_TRUE(other.good());
  auto bytes = test::sound_datagram({.session = 7, .sequence = 1, .sent = kSecond}, SlaveState());
  bytes[4] = kWireVersion + 1;
  const DatagramPlace to(master_place(*master));
  std::atomic<bool> ends = false;
  std::thread speaks([&] {
    for (; !ends; sleep_until(monotonic_now() + 5 * kMillisecond)) (void)!other.send(to, bytes);
  });
  const std::string ours = std::to_string(kWireVersion), theirs = std::to_string(bytes[4]);
  EXPECT_NE(master->after("the slave speaks wire version " + theirs + ", this program " + ours),
            "");
  const pb::DoctorReport report = examined();
  const auto [code, text] = handrail({"status"});
  ends = true;
  speaks.join();
  expect_found(report, "programs.slave_version", Level::PROBLEM,
               "the slave speaks wire version " + theirs + ", the master " + ours,
               "both computers");
  EXPECT_THAT(text, HasSubstr("differs: wire version: master " + ours + ", slave " + theirs));
}

TEST_F(DoctorBesideACell, ASceneThatIsAnotherFileThereIsNamedOnBothSides) {
  master->send(SIGTERM);
  (void)master->finish();
  folder.write("linear-movement.scene", "name: 'linear-movement' mapping { scale: 3 }");
  start_master();
  client.close();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.hash_mismatch_size() > 0; }));
  expect_found(examined(), "scene.same", Level::PROBLEM, "mapping: master ",
               "the same file of scene linear-movement on both computers");
  EXPECT_NE(slave->after("the master's scene 'linear-movement' is another than the file of that "
                         "name here: "),
            "");
  EXPECT_THAT(refusal("engage: true"), HasSubstr("mapping: master "));
}

TEST_F(DoctorBesideACell, AnEngageWithoutASlaveSaysWhereNoneAnsweredAndSoDoesTheLog) {
  slave->kill();
  master->kill();
  start_master();
  client.close();
  EXPECT_THAT(refusal("engage: true"), HasSubstr("no slave has answered at " + link_socket +
                                                 ": start handrail-slave there"));
  EXPECT_NE(master->after("no slave has answered at " + link_socket), "");
}

class DoctorBesideASecureCell : public SecureCell {
 protected:
  // As one who has these keys.
  pb::DoctorReport examined(const std::string& keys) {
    ::setenv("HANDRAIL_KEYS", keys.c_str(), 1);
    return report_of(handrail({"doctor", "--json"}));
  }
  pb::DoctorReport examined() { return examined(master_keys); }
};

TEST_F(DoctorBesideASecureCell, SaysWhoseKeyIsThereAndWhatGoesThrough) {
  ASSERT_TRUE(connected());
  const pb::DoctorReport report = examined();
  const std::string id = key_id(at_slave.load()->key.public_key());
  expect_found(report, "keys.own", Level::OK, "called desk, as master", "");
  expect_found(report, "keys.partner", Level::OK, "cell can work with our key", "");
  expect_found(report, "link.peer", Level::OK, "session with cell, key " + id, "");
  expect_found(report, "route.way", Level::OK, "goes through lo", "");
  expect_found(report, "route.mtu", Level::OK, "a datagram of the link has 643 at most", "");
}

TEST_F(DoctorBesideASecureCell, AKeyThatTheSlaveRemovedIsToldWithTheLineToType) {
  ASSERT_TRUE(connected());
  ASSERT_TRUE(at_slave.save(TrustList(), "a test"));
  ASSERT_TRUE(eventually([](const pb::Status& s) { return !s.peer().problem().empty(); }));
  expect_found(examined(), "link.peer", Level::PROBLEM, "does not trust our key",
               "on that computer, type: handrail keys trust desk master p256:");
}

TEST_F(DoctorBesideASecureCell, AKeyInAnotherRoleIsToldOnBothSides) {
  ASSERT_TRUE(connected());
  TrustList operators;
  ASSERT_TRUE(operators.add({"desk", Role::kOperator, at_master.load()->key.public_key()}));
  ASSERT_TRUE(at_slave.save(operators, "a test"));
  EXPECT_NE(slave->after("is trusted here as operator, not as master"), "");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return !s.peer().problem().empty(); }));
  expect_found(examined(), "link.peer", Level::PROBLEM, " as master", "handrail keys trust desk");
  const pb::DoctorReport there = examined(slave_keys);
  expect_found(there, "keys.partner", Level::PROBLEM, "nobody is trusted here as master",
               "on the master's computer: handrail keys show");
}

TEST_F(DoctorBesideASecureCell, ANameWithoutAddressAndAPortWithoutASlaveAreTold) {
  slave->kill();
  for (const auto& [name, fact] : {std::pair("no-such-host.invalid", "has no address"),
                                   std::pair("127.0.0.1:9", "no slave answers at 127.0.0.1:9")}) {
    master->send(SIGTERM);
    (void)master->finish();
    master =
        launch_with(master_keys, "handrail-master", "operator_socket: '" + socket() + "'", name);
    (void)master->after("READY link=any:");
    client.close();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return !s.peer().problem().empty(); }));
    const pb::DoctorReport report = examined();
    expect_found(report, "link.peer", Level::PROBLEM, fact, "start");
    EXPECT_THAT(refusal("engage: true"), HasSubstr(fact));
  }
}

TEST_F(DoctorBesideASecureCell, AKeyThatOthersCanReadIsNamed) {
  ASSERT_EQ(::chmod(at_master.key_path().c_str(), 0644), 0);
  expect_found(examined(), "keys.own", Level::PROBLEM, "has mode 0644, expected 0600",
               "chmod 600 " + at_master.key_path());
}

}  // namespace
}  // namespace handrail
