// Terminals that are closed or stopped, and logs that nobody reads.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>
#include <unistd.h>

#include "server/base/reason.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class TerminalTest : public WholeCell {
 protected:
  ~TerminalTest() override {
    for (const int end : ends_) {
      if (end >= 0) ::close(end);
    }
  }

  // A pipe into which the programs launched next log. Nobody else has its ends.
  void log_into_a_pipe() {
    ASSERT_EQ(::pipe2(ends_, O_CLOEXEC), 0);
    log_to = ends_[1];
  }
  void log_onto_a_terminal() {
    ASSERT_EQ(::openpty(&ends_[0], &ends_[1], nullptr, nullptr, nullptr), 0);
    for (const int end : ends_) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    log_to = ends_[1];
  }
  void reader_goes() { ::close(std::exchange(ends_[0], -1)); }
  void press(char key) { EXPECT_EQ(::write(ends_[0], &key, 1), 1); }

  // Each makes both sides log a line or more.
  void engage_and_stop() {
    order("engage: true");
    ASSERT_TRUE(slave_reaches("engaged"));
    EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
    order("reset: true");
    ASSERT_TRUE(slave_reaches("off"));
  }

 private:
  int ends_[2] = {-1, -1};
};

constexpr char kStopOutput = 19;  // Ctrl-S

TEST_F(TerminalTest, AClosedTerminalEndsThemAllLikeASignalToEnd) {
  order("engage: true");
  order("hand { displacement_mm: [0, 60, 0] duration_s: 1 }");
  sleep_until(monotonic_now() + 500 * kMillisecond);
  for (Program* program : {slave.get(), master.get(), rig.get()}) {
    program->send(SIGHUP);
    EXPECT_EQ(program->finish(), 0);
  }
  (void)rig->after("external control ended");  // by the slave
}

class SlaveIntoPipe : public TerminalTest {
 protected:
  void SetUp() override {
    start_rig();
    log_into_a_pipe();
    start_slave();
    log_to = -1;
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
};

TEST_F(SlaveIntoPipe, ALogWithoutAReaderIsLostAndSaidSoAndNothingElse) {
  EXPECT_FALSE(status().slave_log_lost());
  reader_goes();
  order("engage: true");
  order("hand { displacement_mm: [0, 20, 0] duration_s: 0.5 }");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.slave_log_lost(); }));
  EXPECT_EQ(at_rest().state(), "engaged");
  EXPECT_THAT(handrail({"status"}).second, HasSubstr("log lines lost: some of the slave"));
  slave->send(SIGTERM);
  EXPECT_EQ(slave->finish(), 0);
}

class OnStoppedTerminal : public TerminalTest {
 protected:
  void SetUp() override {
    log_onto_a_terminal();
    WholeCell::SetUp();
    press(kStopOutput);
  }
};

TEST_F(OnStoppedTerminal, OrdersAreAnsweredAndProgramsEnd) {
  for (int i = 0; i < 5; ++i) engage_and_stop();
  EXPECT_EQ(status().log_lost(), 0u) << "they wait, and are not too many";
  for (Program* program : {master.get(), slave.get(), rig.get()}) {
    program->send(SIGTERM);
    EXPECT_EQ(program->finish(), 0);
  }
}

}  // namespace
}  // namespace handrail
