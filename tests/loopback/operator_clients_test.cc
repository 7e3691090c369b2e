// Many clients, slow clients, clients that leave, and the command line against a served socket.
#include <fcntl.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <memory>
#include <sstream>

#include "client/cli/command.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/loopback/operator_bench.h"

namespace handrail {
namespace {

constexpr Nanos kClientPatience = 20 * kSecond;

class OperatorClients : public testing::Test {
 protected:
  pb::Request order(void (pb::Request::*set)(bool)) {
    pb::Request request;
    (request.*set)(true);
    return request;
  }
  static std::string disengage_of(const std::string& who) {
    pb::Request request;
    request.set_as(who);
    request.set_disengage(true);
    return framed(request.SerializeAsString());
  }
  // Waits for engage orders whose replies the master keeps.
  std::vector<std::function<void(pb::Reply)>> kept(int requests) {
    while (bench_->master.requests < requests) std::this_thread::yield();
    bench_->run([] {});
    return bench_->master.take_kept();
  }
  ExitCode cli(std::vector<std::string> args) {
    args.insert(args.end(), {"--socket", path_});
    out_.str("");
    err_.str("");
    return run_cli(args, Console{out_, err_});
  }
  TempFolder folder_;
  const std::string path_ = folder_.path() + "/operator.sock";
  std::unique_ptr<OperatorBench> bench_ = std::make_unique<OperatorBench>(path_);
  std::ostringstream out_, err_;
};

TEST_F(OperatorClients, HalfAFrameDelaysNobodyAndIsCutOff) {
  RawClient slow(path_);
  ASSERT_TRUE(slow.send(status_frame().substr(0, 5)));
  EXPECT_TRUE(OperatorClient(path_).call(order(&pb::Request::set_status), kClientPatience).is_ok());
  EXPECT_EQ(slow.receive().reason(), "(closed)");
}

TEST_F(OperatorClients, RequestsThatComeTogetherAreAnsweredInOrderAndHalfAnotherIsCutOff) {
  RawClient eager(path_);
  ASSERT_TRUE(eager.send(status_frame() + status_frame() + status_frame().substr(0, 5)));
  EXPECT_EQ(eager.receive().status().ticks(), 1u);
  EXPECT_EQ(eager.receive().status().ticks(), 2u);
  EXPECT_EQ(eager.receive().reason(), "(closed)");
}

TEST_F(OperatorClients, ARequestInPiecesIsOne) {
  RawClient slow(path_);
  for (const char byte : status_frame()) {
    ASSERT_TRUE(slow.send(std::string(1, byte)));
    sleep_until(monotonic_now() + kMillisecond);
  }
  EXPECT_EQ(slow.receive().status().ticks(), 1u);
}

// Four places: who gives orders keeps his, however many come who only ask.
TEST_F(OperatorClients, WhoeverComesIsLetInAndWhoOnlyAsksMakesRoom) {
  bench_.reset();
  bench_ = std::make_unique<OperatorBench>(path_, 4);
  RawClient driver(path_);
  ASSERT_TRUE(driver.send(framed(order(&pb::Request::set_disengage).SerializeAsString())));
  ASSERT_TRUE(driver.receive().done());
  std::vector<std::unique_ptr<RawClient>> askers;
  for (int i = 0; i < 20; ++i) {
    askers.push_back(std::make_unique<RawClient>(path_));
    ASSERT_TRUE(askers.back()->send(status_frame()));
    ASSERT_TRUE(askers.back()->receive().done()) << i;
  }
  EXPECT_EQ(bench_->clients(), 4u);
  EXPECT_EQ(askers[0]->receive().reason(), "another client took your place: there is room for 4");
  EXPECT_EQ(askers[0]->receive().reason(), "(closed)");
  for (int i = 17; i < 20; ++i) {
    auto& asker = *askers[static_cast<std::size_t>(i)];
    ASSERT_TRUE(asker.send(status_frame()));
    EXPECT_TRUE(asker.receive().done()) << i;
  }
  ASSERT_TRUE(driver.send(status_frame()));
  EXPECT_TRUE(driver.receive().done());
}

// Four places: orders that the lease refuses keep none.
TEST_F(OperatorClients, WhoMayNotDriveMakesRoomForWhoMay) {
  bench_.reset();
  bench_ = std::make_unique<OperatorBench>(path_, 4);
  bench_->run([this] { bench_->master.holder = "ada"; });
  RawClient driver(path_), stopper(path_);
  ASSERT_TRUE(driver.send(disengage_of("ada")));
  ASSERT_TRUE(driver.receive().done());
  bench_->master.keeps_stops = true;
  ASSERT_TRUE(stopper.send(framed(order(&pb::Request::set_stop).SerializeAsString())));
  while (bench_->master.requests < 2) std::this_thread::yield();
  std::vector<std::unique_ptr<RawClient>> others;
  for (int i = 0; i < 20; ++i) {
    others.push_back(std::make_unique<RawClient>(path_));
    ASSERT_TRUE(others.back()->send(disengage_of("eve")));
    ASSERT_TRUE(others.back()->receive().done()) << i;
  }
  EXPECT_EQ(others[0]->receive().reason(), "another client took your place: there is room for 4");
  ASSERT_TRUE(driver.send(status_frame()));
  EXPECT_TRUE(driver.receive().done()) << "who drives keeps his place";
  pb::Reply stopped;
  stopped.set_reason("the slave has it");
  for (const auto& reply : bench_->master.take_kept()) reply(stopped);
  EXPECT_EQ(stopper.receive().reason(), "the slave has it");
  // With the lease he has lost it.
  bench_->run([this] { bench_->master.holder = "bob"; });
  for (int i = 0; i < 4; ++i) {
    others.push_back(std::make_unique<RawClient>(path_));
    ASSERT_TRUE(others.back()->send(status_frame()));
    ASSERT_TRUE(others.back()->receive().done()) << i;
  }
  EXPECT_EQ(driver.receive().reason(), "another client took your place: there is room for 4");
}

TEST_F(OperatorClients, AnOrderOfWhoMayDrivePassesAllOthers) {
  bench_->run([this] { bench_->master.holder = "ada"; });
  std::vector<std::unique_ptr<RawClient>> others;
  std::unique_ptr<RawClient> driver;
  bench_->run([&] {
    for (int i = 0; i < 500; ++i) {
      others.push_back(std::make_unique<RawClient>(path_));
      EXPECT_TRUE(others.back()->send(disengage_of("eve")));
    }
    driver = std::make_unique<RawClient>(path_);
    EXPECT_TRUE(driver->send(disengage_of("ada")));
  });
  EXPECT_TRUE(driver->receive().done());
  EXPECT_LT(bench_->master.requests, 450);
  for (const auto& other : others) EXPECT_TRUE(other->receive().done());
}

// All have come and asked before the server looks: the stop, who came last, goes first.
TEST_F(OperatorClients, AStopPassesEverybodyWhoAsks) {
  std::vector<std::unique_ptr<RawClient>> askers;
  std::unique_ptr<RawClient> stopper;
  bench_->run([&] {
    for (int i = 0; i < 500; ++i) {
      askers.push_back(std::make_unique<RawClient>(path_));
      EXPECT_TRUE(askers.back()->send(status_frame()));
    }
    stopper = std::make_unique<RawClient>(path_);
    EXPECT_TRUE(stopper->send(framed(order(&pb::Request::set_stop).SerializeAsString())));
  });
  EXPECT_EQ(stopper->receive().reason(), "(closed)") << "as the scripted master answers it";
  EXPECT_LT(bench_->master.requests, 450);
  for (const auto& asker : askers) EXPECT_TRUE(asker->receive().done());
}

TEST_F(OperatorClients, TheMasterMayAnswerLaterFromAnyThread) {
  RawClient waiting(path_);
  ASSERT_TRUE(waiting.send(framed(order(&pb::Request::set_engage).SerializeAsString())));
  auto replies = kept(1);
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_TRUE(OperatorClient(path_).call(order(&pb::Request::set_status), kClientPatience).is_ok());
  pb::Reply reply;
  reply.set_done(true);
  reply.set_reason("at last");
  replies[0](reply);
  EXPECT_EQ(waiting.receive().reason(), "at last");
}

TEST_F(OperatorClients, AnAnswerToAClientThatLeftHarmsNobody) {
  {
    RawClient leaving(path_);
    ASSERT_TRUE(leaving.send(framed(order(&pb::Request::set_engage).SerializeAsString())));
    while (bench_->master.requests < 1) std::this_thread::yield();
  }
  for (const auto& reply : kept(1)) reply(pb::Reply());
  EXPECT_TRUE(OperatorClient(path_).call(order(&pb::Request::set_status), kClientPatience).is_ok());
}

TEST_F(OperatorClients, AnAnswerAfterTheServerStoppedHarmsNobody) {
  RawClient waiting(path_);
  ASSERT_TRUE(waiting.send(framed(order(&pb::Request::set_engage).SerializeAsString())));
  const auto replies = kept(1);
  bench_.reset();
  EXPECT_EQ(waiting.receive().reason(), "(closed)");
}

TEST_F(OperatorClients, ADroppedReplyClosesTheConnection) {
  const auto reply = OperatorClient(path_).call(order(&pb::Request::set_stop), kClientPatience);
  EXPECT_EQ(reply.message(), "no master on " + path_ + ": it closed the connection");
  EXPECT_EQ(exit_code(reply), kExitNoMaster);
}

TEST_F(OperatorClients, GiveUpOnASilentMaster) {
  const auto reply = OperatorClient(path_).call(order(&pb::Request::set_engage), 30 * kMillisecond);
  EXPECT_EQ(reply.message(), "no master on " + path_ + ": no answer in time");
}

// UBSan itself needs descriptors, to look at what it judges.
#ifndef __SANITIZE_ADDRESS__
TEST_F(OperatorClients, SayThatNoDescriptorIsLeft) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};  // of new ones
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  OperatorClient client(path_);
  const auto reply = client.call(order(&pb::Request::set_status), kClientPatience);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(reply.message(), "no master on " + path_ + ": Too many open files");
  EXPECT_TRUE(client.call(order(&pb::Request::set_status), kClientPatience).is_ok());
}
#endif

// The descriptors that lead to a named socket and that a program started now would inherit.
int inherited() {
  int count = 0;
  for (int fd = 0; fd < 256; ++fd) {
    sockaddr_un peer{};
    socklen_t size = sizeof(peer);
    if (::getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &size) != 0) continue;
    const bool named = peer.sun_family == AF_UNIX && peer.sun_path[0] != '\0';
    count += named && (::fcntl(fd, F_GETFD) & FD_CLOEXEC) == 0;
  }
  return count;
}

TEST_F(OperatorClients, AreNotInheritedByAProgramThatIsStartedMeanwhile) {
  OperatorClient client(path_);
  ASSERT_TRUE(client.call(order(&pb::Request::set_status), kClientPatience).is_ok());
  EXPECT_EQ(inherited(), 0);
}

TEST_F(OperatorClients, ConnectAgainAfterTheMasterRestarted) {
  OperatorClient client(path_);
  ASSERT_TRUE(client.call(order(&pb::Request::set_status), kClientPatience).is_ok());
  bench_.reset();
  EXPECT_FALSE(client.call(order(&pb::Request::set_status), kClientPatience).is_ok());
  EXPECT_EQ(client.call(order(&pb::Request::set_status), kClientPatience).message(),
            "no master on " + path_ + ": no such socket; start handrail-master");
  bench_ = std::make_unique<OperatorBench>(path_);
  EXPECT_TRUE(client.call(order(&pb::Request::set_status), kClientPatience).is_ok());
}

TEST_F(OperatorClients, CliExitsWithOneAndTheMastersReasonWhenRefused) {
  EXPECT_EQ(cli({"reset"}), kExitRefused);
  EXPECT_EQ(err_.str(), "handrail: refused: nothing to reset\n");
}

TEST_F(OperatorClients, CliSendsTheOrderItWasGiven) {
  EXPECT_EQ(cli({"clutch", "on"}), kExitDone);
  EXPECT_EQ(out_.str(), "clutch on (clutch: true)\n");
  EXPECT_EQ(cli({"tool", "off", "position"}), kExitDone);
  EXPECT_EQ(out_.str(), "tool off (tool_off { position: true orientation: false })\n");
  EXPECT_EQ(cli({"tool", "line", "--dir", "-x", "--at", "-1,2,3"}), kExitDone);
  EXPECT_EQ(out_.str(),
            "tool called (tool { kind: LINE at_mm: -1 at_mm: 2 at_mm: 3 direction: -1 direction: 0 "
            "direction: 0 })\n");
  EXPECT_EQ(cli({"tool", "point", "--at", "-1,2,3", "--approach"}), kExitDone);
  EXPECT_EQ(out_.str(),
            "tool called (tool { kind: POINT at_mm: -1 at_mm: 2 at_mm: 3 } approach: true)\n");
  EXPECT_EQ(cli({"hand", "to", "--by", "-1,0,0", "--seconds", "2"}), kExitDone);
  EXPECT_EQ(out_.str(),
            "hand moves (hand { displacement_mm: -1 displacement_mm: 0 displacement_mm: 0 "
            "rotation_deg: 0 rotation_deg: 0 rotation_deg: 0 duration_s: 2 })\n");
}

TEST_F(OperatorClients, CliPrintsStatusAsJsonWithTheFieldsOwnNames) {
  EXPECT_EQ(cli({"status", "--json"}), kExitDone);
  pb::Status status;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(out_.str(), &status).ok()) << out_.str();
  EXPECT_EQ(status.ticks(), 1U);
  EXPECT_NE(out_.str().find("\"packet_age_ms\": 0"), std::string::npos);
}

TEST_F(OperatorClients, CliWatchPrintsOneJsonObjectALineUntilInterrupted) {
  bench_->run([this] {
    bench_->master.on_status = [](int n) {
      if (n == 3) ::kill(::getpid(), SIGINT);
    };
  });
  EXPECT_EQ(cli({"status", "--watch", "--json"}), kExitDone);
  std::istringstream lines(out_.str());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    pb::Status status;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(line, &status).ok()) << line;
  }
  EXPECT_GE(count, 2);
  ::signal(SIGINT, SIG_DFL);
  EXPECT_EQ(cli({"status"}), kExitDone);
  EXPECT_NE(out_.str(), "");
}

TEST_F(OperatorClients, CliWatchesWhyAsALineForEachChangeWhereThereIsNoTerminal) {
  bench_->run([this] {
    bench_->master.on_status = [](int n) {
      if (n == 7) ::kill(::getpid(), SIGINT);
    };
    bench_->master.why = [](int n) { return n < 3 || n > 4 ? "the arm holds" : "it follows"; };
  });
  // What is watched first is shown, whatever was seen by an earlier command.
  for (int run = 0; run < 2; ++run) {
    bench_->master.requests = 0;
    EXPECT_EQ(cli({"why", "--watch"}), kExitDone);
    EXPECT_EQ(out_.str(), "the arm holds\nit follows\nthe arm holds\n");
    ::signal(SIGINT, SIG_DFL);
  }
}

}  // namespace
}  // namespace handrail
