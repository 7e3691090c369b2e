// Terminals that are closed, stopped or not read, and logs that nobody reads.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "devices/rig/tap.h"
#include "server/model/reason.h"
#include "tests/loopback/whole_cell.h"
#include "tests/storm/judge.h"
#include "tests/support/full_stream.h"
#include "tests/support/pseudo_terminal.h"

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
    streams.error = ends_[1];
  }
  void log_onto_a_terminal() {
    ASSERT_EQ(::openpty(&ends_[0], &ends_[1], nullptr, nullptr, nullptr), 0);
    for (const int end : ends_) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    streams.error = ends_[1];
  }
  void reader_goes() { ::close(std::exchange(ends_[0], -1)); }
  void press(char key) { EXPECT_EQ(::write(ends_[0], &key, 1), 1); }
  // Full, but for `room` bytes.
  void leave_room(std::size_t room) {
    test::fill(ends_[1]);
    std::string taken(room, ' ');
    EXPECT_EQ(::read(ends_[0], taken.data(), room), static_cast<ssize_t>(room));
  }

  // Each makes both sides log a line or more.
  void engage_and_stop() {
    order("engage: true");
    ASSERT_TRUE(slave_reaches("engaged"));
    EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
    order("reset: true");
    ASSERT_TRUE(slave_reaches("off"));
  }
  void expect_all_to_end_at_once() {
    const Nanos start = monotonic_now();
    for (Program* program : {master.get(), slave.get(), rig.get()}) program->send(SIGTERM);
    for (Program* program : {master.get(), slave.get(), rig.get()}) {
      EXPECT_EQ(program->finish(), 0);
    }
    EXPECT_LT(monotonic_now() - start, 10 * kSecond) << "for good, if they waited";
  }

 private:
  int ends_[2] = {-1, -1};
};

constexpr char kStopOutput = 19;  // Ctrl-S

// Each of the programs on a terminal of its own.
class OwnTerminals : public TerminalTest {
 protected:
  void SetUp() override {
    rig_extra = "tap: '" + tap() + "'";
    streams.terminal = open_terminal("rig");
    start_rig();
    streams.terminal = open_terminal("slave");
    start_slave();
    streams.terminal = open_terminal("master");
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
  ~OwnTerminals() override {
    for (const auto& [name, end] : terminals_) ::close(end);
  }

  std::string tap() const { return folder.path() + "/rig.tap"; }
  void close_terminal(const std::string& of) {
    ::close(terminals_.at(of));
    terminals_.erase(of);
  }
  // Until the arm is well under way.
  void set_in_motion() {
    order("engage: true");
    ASSERT_TRUE(slave_reaches("engaged"));
    const Vec3 start = mm(status().slave_command());
    order("hand { displacement_mm: [0, 60, 0] duration_s: 2 }");
    ASSERT_TRUE(eventually(
        [&](const pb::Status& s) { return (mm(s.slave_command()) - start).norm() > 10.0; }));
  }
  // What the controller saw, whatever the programs say.
  TapFile judged() {
    const Result<TapFile> file = read_tap(tap());
    EXPECT_TRUE(file) << file.message();
    if (!file) return {};
    std::vector<storm::Violation> violations;
    const storm::Figures figures = storm::judge_tap(*file, {}, violations);
    for (const auto& violation : violations) ADD_FAILURE() << violation.what;
    EXPECT_EQ(figures.halts, 0u) << "the arm was stopped short of its plan";
    return *file;
  }

 private:
  std::string open_terminal(const std::string& name) {
    const int end = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_EQ(::grantpt(end), 0);
    EXPECT_EQ(::unlockpt(end), 0);
    terminals_[name] = end;
    return ::ptsname(end);
  }
  std::map<std::string, int> terminals_;
};

TEST_F(OwnTerminals, ASlaveWhoseTerminalIsClosedStopsTheArmByItsPlanAndSaysGoodbye) {
  set_in_motion();
  close_terminal("slave");
  EXPECT_EQ(slave->finish(), 0);
  (void)rig->output();
  // The rig takes the END in its next cycle: the slave may be gone before it.
  EXPECT_TRUE(within(kPatience, [&] {
    const Result<TapFile> file = read_tap(tap());
    return file && std::any_of(file->records.begin(), file->records.end(),
                               [](const TapRecord& r) { return r.has(kTapClosed); });
  })) << "no END";
  EXPECT_FALSE(judged().records.empty());
}

TEST_F(OwnTerminals, AMasterWhoseTerminalIsClosedDisengages) {
  set_in_motion();
  close_terminal("master");
  EXPECT_EQ(master->finish(), 0);
  EXPECT_FALSE(std::filesystem::exists(socket())) << "it ended in order";
  sleep_until(monotonic_now() + kSecond);
  const TapFile file = judged();
  ASSERT_FALSE(file.records.empty());
  EXPECT_TRUE(file.records.back().has(kTapSession)) << "the slave goes on";
  EXPECT_TRUE(slave->running());
}

TEST_F(OwnTerminals, ARigWhoseTerminalIsClosedEndsAndTheSlaveGoesOn) {
  set_in_motion();
  close_terminal("rig");
  EXPECT_EQ(rig->finish(), 0);
  EXPECT_TRUE(slave_reaches("fault"));
  EXPECT_TRUE(slave->running());
}

class Nohup : public OwnTerminals {
 protected:
  void SetUp() override {
    streams.ignores_hang_up = true;
    const auto before = ::signal(SIGHUP, SIG_IGN);
    OwnTerminals::SetUp();
    ::signal(SIGHUP, before);
  }
};

TEST_F(Nohup, TheArmMovesOnWithoutATerminal) {
  set_in_motion();
  for (const char* of : {"master", "slave", "rig"}) close_terminal(of);
  const pb::Status last = at_rest();
  EXPECT_EQ(last.state(), "engaged");
  EXPECT_EQ(last.slave_state(), "engaged");
  engage_and_stop();
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.log_lost() > 0; }));
  expect_all_to_end_at_once();
}

TEST_F(TerminalTest, AWatchedStatusAndWhyArePaintedInPlaceOnOneScreen) {
  const std::string repaint = "\033[H\033[J";
  for (const char* what : {"status", "why"}) {
    PseudoTerminal terminal;
    ASSERT_TRUE(terminal.works());
    Streams onto;
    onto.output = terminal.program();
    Program watch(folder, "handrail", {what, "--watch", "--socket", socket()}, onto);
    std::string said = terminal.shown_until(repaint, 4, kPatience);
    watch.send(SIGINT);
    EXPECT_EQ(watch.finish(), 0);
    ASSERT_TRUE(said.starts_with(repaint)) << said;
    while (!said.empty()) {
      const std::size_t next = std::min(said.find(repaint, 1), said.size());
      const auto lines = std::count(said.begin(), said.begin() + static_cast<long>(next), '\n');
      EXPECT_LT(lines, 24) << "the last line scrolls a terminal of 24";
      said.erase(0, next);
    }
  }
}

TEST_F(TerminalTest, AWatchAtAStoppedTerminalEndsWhenItIsTold) {
  for (const char* what : {"status", "why"}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      PseudoTerminal terminal;
      ASSERT_TRUE(terminal.works());
      Streams onto;
      onto.output = terminal.program();
      Program watch(folder, "handrail", {what, "--watch", "--socket", socket()}, onto);
      ASSERT_NE(terminal.shown_until("\033[H\033[J", 2, kPatience), "");
      ASSERT_EQ(::tcflow(terminal.program(), TCOOFF), 0);
      sleep_until(monotonic_now() + kSecond);  // it waits for the terminal
      const Nanos told = monotonic_now();
      watch.send(signal);
      EXPECT_EQ(watch.finish(), 0) << watch.output();
      EXPECT_LT(monotonic_now() - told, 10 * kSecond);
    }
  }
}

class SlaveIntoPipe : public TerminalTest {
 protected:
  void SetUp() override {
    start_rig();
    log_into_a_pipe();
    start_slave();
    streams.error = -1;
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
  expect_all_to_end_at_once();
}

class OnUnreadTerminal : public TerminalTest {
 protected:
  void SetUp() override {
    log_onto_a_terminal();
    WholeCell::SetUp();
  }
};

TEST_F(OnUnreadTerminal, OrdersAreAnsweredAndProgramsEndThoughNoLineFits) {
  leave_room(20);
  for (int i = 0; i < 2; ++i) engage_and_stop();
  expect_all_to_end_at_once();
}

class IntoOnePipe : public TerminalTest {
 protected:
  void SetUp() override {
    log_into_a_pipe();
    WholeCell::SetUp();
  }
};

TEST_F(IntoOnePipe, ThreeProgramsEndThoughNobodyReads) {
  leave_room(4096);
  for (int i = 0; i < 2; ++i) engage_and_stop();
  expect_all_to_end_at_once();
}

class MasterIntoPipe : public TerminalTest {
 protected:
  void SetUp() override {
    start_rig();
    start_slave();
    log_into_a_pipe();
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
};

TEST_F(MasterIntoPipe, AMasterWithoutAReaderServesOn) {
  reader_goes();
  engage_and_stop();
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.log_lost() > 0; }));
  engage_and_stop();
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 0);
}

class RigIntoPipe : public TerminalTest {
 protected:
  void SetUp() override {
    log_into_a_pipe();
    start_rig();
    streams.error = -1;
    start_slave();
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
};

TEST_F(RigIntoPipe, ARigWithoutAReaderKeepsItsCycle) {
  reader_goes();
  slave->send(SIGTERM);  // which the rig says
  EXPECT_EQ(slave->finish(), 0);
  start_slave();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() < 20.0; }));
  ASSERT_TRUE(slave_reaches("off"));
  engage_and_stop();
  rig->send(SIGTERM);
  EXPECT_EQ(rig->finish(), 0);
}

}  // namespace
}  // namespace handrail
