// Programs that are told to end while they start, and whose starter does not listen.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "devices/rig/tap.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/full_stream.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class StartTest : public WholeCell {
 protected:
  void SetUp() override {}

  // How often the rig has been taken under external control.
  int sessions() const {
    const std::string said = rig->output();
    int count = 0;
    for (std::size_t at = 0; (at = said.find("external control by", at)) != said.npos; ++at) {
      ++count;
    }
    return count;
  }
  // All of them anew, on the ports that they had, where nobody reads their READY; then they serve.
  void serve_with_output(int output) {
    WholeCell::SetUp();
    for (Program* program : {slave.get(), master.get(), rig.get()}) {
      program->send(SIGTERM);
      ASSERT_EQ(program->finish(), 0);
    }
    client.close();
    streams.output = output;
    rig = launch("handrail-rig", "robot_port: " + std::to_string(robot_port) +
                                     " sensor_port: " + std::to_string(sensor_port));
    launch_slave();
    master = launch("handrail-master", master_config());
    ASSERT_TRUE(within(kPatience, [&] {
      pb::Request request;
      request.set_status(true);
      const Result<pb::Reply> reply = client.call(request, kSecond);
      return reply && reply->done() && reply->status().has_tip();
    }));
    order("engage: true");
    EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
    slave->send(SIGTERM);
    EXPECT_EQ(slave->finish(), 0);
  }
  void end_master_and_rig() {
    for (Program* program : {master.get(), rig.get()}) {
      program->send(SIGTERM);
      EXPECT_EQ(program->finish(), 0);
    }
  }
};

TEST_F(StartTest, ASignalBeforeTheSlaveServesEndsItInOrder) {
  rig_extra = "tap: '" + folder.path() + "/rig.tap'";
  start_rig();
  constexpr int kStarts = 5;
  for (int i = 1; i <= kStarts; ++i) {
    launch_slave();
    ASSERT_TRUE(within(kPatience, [&] { return sessions() == i; }));
    slave->send(SIGTERM);
    ASSERT_EQ(slave->finish(), 0);
  }
  // The rig takes the last END in its next cycle: the slave may be gone before it.
  EXPECT_TRUE(within(kPatience, [&] {
    const auto file = read_tap(folder.path() + "/rig.tap");
    return file && std::count_if(file->records.begin(), file->records.end(),
                                 [](const TapRecord& r) { return r.has(kTapClosed); }) == kStarts;
  }));
}

TEST_F(StartTest, ASignalBeforeTheMasterServesEndsItInOrder) {
  for (int i = 0; i < 5; ++i) {
    master = launch("handrail-master", master_config());
    ASSERT_TRUE(within(kPatience, [&] { return std::filesystem::exists(socket()); }));
    master->send(SIGTERM);
    ASSERT_EQ(master->finish(), 0);
    ASSERT_FALSE(std::filesystem::exists(socket()));
  }
}

// It waits on the socket while the master takes its memory and priority.
TEST_F(StartTest, AnOrderThatWaitsForTheMasterToServeIsCarriedOut) {
  pb::Request request;
  request.set_scene_load("plane");
  for (int i = 0; i < 5; ++i) {
    master = launch("handrail-master", master_config());
    Result<pb::Reply> reply = Status::error("not asked");
    ASSERT_TRUE(within(kPatience, [&] {
      reply = client.call(request, kPatience);
      return reply.is_ok();
    })) << reply.message();
    EXPECT_TRUE(reply->done()) << reply->reason();
    client.close();
    master->send(SIGTERM);
    ASSERT_EQ(master->finish(), 0);
  }
}

TEST_F(StartTest, AFullStandardOutputKeepsNobodyWaiting) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  test::fill(ends[1]);
  ASSERT_NO_FATAL_FAILURE(serve_with_output(ends[1]));
  // Who reads at last finds the line.
  std::string text;
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  EXPECT_TRUE(within(kPatience, [&] {
    std::array<char, 4096> part;
    for (ssize_t n; (n = ::read(ends[0], part.data(), part.size())) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(n));
    }
    return text.find("READY link=" + master_place(*master) + " ") != text.npos;
  }));
  end_master_and_rig();
  for (const int end : ends) ::close(end);
}

TEST_F(StartTest, AReadyLineThatCannotBeWrittenKeepsNobodyFromServing) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  if (full < 0) GTEST_SKIP() << "needs /dev/full";
  ASSERT_NO_FATAL_FAILURE(serve_with_output(full));
  end_master_and_rig();
  ::close(full);
}

}  // namespace
}  // namespace handrail
