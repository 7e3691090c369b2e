// The rig's status socket: what is told of the workpiece, and which orders are none.
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "client/api/rig_client.h"
#include "devices/rig/rig_server.h"
#include "devices/rig/rig_status_server.h"
#include "server/base/clock.h"
#include "server/base/length_prefix.h"
#include "server/base/pacer.h"
#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

pb::RigReply read(const std::string& bytes) {
  pb::RigReply out;
  EXPECT_TRUE(out.ParseFromString(bytes));
  return out;
}
std::string look_order(std::optional<std::uint64_t> since) {
  pb::RigOrder order;
  order.mutable_look();
  if (since) order.mutable_look()->set_since(*since);
  return order.SerializeAsString();
}
std::string play_order(const std::string& scene, bool anew) {
  pb::RigOrder order;
  order.mutable_play()->set_scene(scene);
  order.mutable_play()->set_anew(anew);
  return order.SerializeAsString();
}

// A board whose rig notes what it was to play.
struct Board {
  std::vector<std::string> found;
  int played = 0;
  Result<std::optional<TipInside>> outcome{std::optional<TipInside>()};
  RigBoard board{"plane",
                 [this](const std::string& name) -> Result<Workpiece> {
                   found.push_back(name);
                   if (name == "none") return Status::error("no such scene");
                   return Workpiece();
                 },
                 [this](const Workpiece&) {
                   ++played;
                   return outcome;
                 }};
};

TEST(RigBoard, TellsTheNewestOrAllSince) {
  Board it;
  EXPECT_EQ(read(it.board.answer(look_order({}))).status().moment_size(), 0);
  for (std::uint64_t i = 1; i <= kKeptMoments + 100; ++i) {
    RigMoment moment;
    moment.number = i;
    moment.workpiece = 1;
    moment.has_socket = true;
    moment.turned = kDeg;
    moment.depth = i % 2 == 0 ? 2e-3 : -std::numeric_limits<double>::infinity();
    it.board.hear(moment);
  }
  const pb::RigStatus newest = read(it.board.answer(look_order({}))).status();
  EXPECT_EQ(newest.scene(), "plane");
  ASSERT_EQ(newest.moment_size(), 1);
  EXPECT_EQ(newest.moment(0).number(), kKeptMoments + 100);
  EXPECT_DOUBLE_EQ(newest.moment(0).screw().turned_deg(), 1.0);
  EXPECT_DOUBLE_EQ(newest.moment(0).screw().depth_mm(), 2.0);
  const std::string some = it.board.answer(look_order(kKeptMoments + 90));
  ASSERT_EQ(read(some).status().moment_size(), 10);
  EXPECT_EQ(read(some).status().moment(0).number(), kKeptMoments + 91);
  EXPECT_FALSE(read(some).status().moment(0).screw().has_depth_mm()) << "beside the mouth";
  // An answer is bounded, and what was long ago is gone.
  const std::string most = it.board.answer(look_order(0));
  ASSERT_EQ(read(most).status().moment_size(), static_cast<int>(kMostMoments));
  EXPECT_EQ(read(most).status().moment(0).number(), 101u);
  EXPECT_LT(most.size(), kMaxFrame);
}

TEST(RigBoard, PlaysWhatIsAskedForAndSaysWhyNot) {
  Board it;
  EXPECT_TRUE(read(it.board.answer(play_order("plane", false))).done());
  EXPECT_EQ(it.played, 0) << "is there already";
  EXPECT_TRUE(read(it.board.answer(play_order("plane", true))).done());
  EXPECT_EQ(it.played, 1);
  it.outcome = std::optional(TipInside{RigEffectKind::kHexSocket, 6e-3});
  const pb::RigReply inside = read(it.board.answer(play_order("screw-fastening", false)));
  EXPECT_FALSE(inside.done());
  EXPECT_EQ(
      inside.reason(),
      "play: scene 'screw-fastening': the tip would be 6.0 mm inside its hex_socket: drive the "
      "arm out of it first");
  EXPECT_EQ(read(it.board.answer(look_order({}))).status().scene(), "plane");
  it.outcome = Status::error("late");
  EXPECT_THAT(read(it.board.answer(play_order("wrench", false))).reason(), HasSubstr("late"));
  EXPECT_THAT(read(it.board.answer(play_order("none", false))).reason(),
              HasSubstr("play: scene 'none': no such scene"));
  EXPECT_THAT(read(it.board.answer(play_order("\033[2J", false))).reason(),
              testing::Not(HasSubstr("\033")));
}

TEST(RigBoard, WhatIsNoOrderIsToldSo) {
  Board it;
  EXPECT_EQ(read(it.board.answer("\xff\xff")).reason(), "an order of 2 bytes is garbled");
  EXPECT_EQ(read(it.board.answer("")).reason(), "the order is none, expected look or play");
}

TEST(RigFeed, TellingAllocatesNothingAndWaitsForNobody) {
  Rig rig(RigOptions{}, 0);
  const auto feed = std::make_unique<RigFeed>(false);
  {
    const test::NoAllocation guard("telling and serving");
    for (int i = 0; i < 3000; ++i) feed->tell(rig);
    feed->serve(rig);
  }
  RigMoment moment;
  int heard = 0;
  while (feed->hear(moment)) ++heard;
  EXPECT_EQ(heard, 1024);
  feed->tell(rig);
  ASSERT_TRUE(feed->hear(moment));
  EXPECT_EQ(moment.number, 3001u) << "those left out are counted";
  const auto played = feed->play(Workpiece(), 20 * kMillisecond);
  ASSERT_FALSE(played);
  EXPECT_THAT(played.message(), HasSubstr("has not come by"));
}

// The socket of a rig that runs.
class RigStatusSocket : public ::testing::Test {
 protected:
  RigStatusSocket() {
    EXPECT_TRUE(rig.open("127.0.0.1", 0, 0));
    rig.tell(feed);
    const Status started = status.start(path);
    EXPECT_TRUE(started) << started.message();
    thread = std::thread([this] { rig.run(); });
  }
  ~RigStatusSocket() override {
    rig.stop();
    thread.join();
  }
  // A connection that says `bytes`; what comes back until it is closed.
  int raw(const std::string& bytes) const {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
    return fd;
  }
  static std::string rest_of(int fd) {
    std::string out;
    char part[512];
    for (ssize_t n; (n = ::recv(fd, part, sizeof(part), 0)) > 0;)
      out.append(part, static_cast<std::size_t>(n));
    ::close(fd);
    return out;
  }

  TempFolder folder;
  std::string path = folder.path() + "/rig.sock";
  RigFeed feed{false};
  RigServer rig{RigOptions{}};
  RigStatusServer status{feed, "", workpiece_finder({})};
  std::thread thread;
  RigClient client{path};
};

TEST_F(RigStatusSocket, TellsEveryMomentAndPlaysAScene) {
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
  EXPECT_FALSE(client.look(nullptr, kSecond)->has_scene());
  const Status played = client.play("screw-fastening", true, 2 * kSecond);
  ASSERT_TRUE(played) << played.message();
  std::uint64_t last = 0;
  int seen = 0;
  for (const Nanos end = monotonic_now() + 500 * kMillisecond; monotonic_now() < end;) {
    const auto now = client.look(&last, kSecond);
    ASSERT_TRUE(now) << now.message();
    EXPECT_EQ(now->scene(), "screw-fastening");
    for (const pb::RigMoment& moment : now->moment()) {
      EXPECT_TRUE(last == 0 || moment.number() == last + 1) << moment.number();
      last = moment.number();
      ++seen;
      EXPECT_TRUE(moment.has_screw());
    }
    sleep_until(monotonic_now() + 7 * kMillisecond);
  }
  EXPECT_GT(seen, 300);
  const Status none = client.play("nothing", true, kSecond);
  EXPECT_THAT(none.message(), HasSubstr("the rig: play: scene 'nothing': "));
}

TEST_F(RigStatusSocket, WhoSaysNonsenseIsToldSoAndCutOff) {
  const std::string answer = rest_of(raw(std::string("\xff\xff\xff\x7f", 4)));
  ASSERT_GT(answer.size(), kFrameHeader);
  EXPECT_EQ(read(answer.substr(kFrameHeader)).reason(),
            "an order of 2147483647 bytes, expected at most 4096");
  // In the middle of an order: for its patience, and the others are served meanwhile.
  const int slow = raw(std::string("\x08\0\0\0x", 5));
  EXPECT_TRUE(client.look(nullptr, kSecond));
  const Nanos from = monotonic_now();
  EXPECT_EQ(rest_of(slow), "");
  EXPECT_GT(monotonic_now() - from, kSecond);
}

TEST_F(RigStatusSocket, WhereThereIsNoRoomTheLongestUnheardGoes) {
  std::vector<int> idle;
  for (std::size_t i = 0; i < RigStatusServer::kMostClients; ++i) idle.push_back(raw(""));
  EXPECT_TRUE(client.look(nullptr, kSecond));
  EXPECT_THAT(rest_of(idle.front()), HasSubstr("another client took your place"));
  for (std::size_t i = 1; i < idle.size(); ++i) ::close(idle[i]);
}

TEST(RigClient, SaysThatThereIsNoRig) {
  TempFolder folder;
  RigClient client(folder.path() + "/none.sock");
  const auto now = client.look(nullptr, kSecond);
  ASSERT_FALSE(now);
  EXPECT_EQ(now.message(),
            "no simulated rig on " + folder.path() +
                "/none.sock: no such socket; start handrail-rig with status_socket in "
                "its --config");
}

}  // namespace
}  // namespace handrail
