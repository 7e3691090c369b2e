// The real programs where the machine has little to give: descriptors, memory, a disk that can be
// written, ports, real time, processors. They start whole or say what is missing; what runs goes
// on.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <list>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/loopback/raw_client.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

const char* const kPrograms[] = {"handrail-master", "handrail-slave", "handrail-rig"};

// Under a command that takes a command, such as prlimit.
std::unique_ptr<Program> under(const TempFolder& folder, std::vector<std::string> command,
                               const std::string& name, const std::string& config) {
  const std::string first = command.front();
  command.erase(command.begin());
  command.insert(command.end(),
                 {HANDRAIL_BIN_DIR "/" + name, "--config", folder.write(name + ".cfg", config)});
  return std::make_unique<Program>(folder, first, command);
}

// The sanitizers themselves need descriptors and memory.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
std::string on_any_port(const TempFolder& folder, const std::string& name) {
  if (name == "handrail-slave") return "link_socket: '" + folder.path() + "/op/l'";
  if (name == "handrail-rig") return "robot_port: 0 sensor_port: 0";
  return "link_socket: '" + folder.path() + "/op/l' operator_socket: '" + folder.path() + "/op/s'";
}

// Whether it lives long enough to say its version: where a library of others finds no memory before
// main() begins, nothing of ours has run.
bool says_its_version(const TempFolder& folder, std::vector<std::string> command,
                      const std::string& name) {
  const std::string first = command.front();
  command.erase(command.begin());
  command.insert(command.end(), {HANDRAIL_BIN_DIR "/" + name, "--version"});
  Program program(folder, first, command);
  return program.finish() == 0;
}

// Whether it is ready; it ends either way. One that is not says why, and leaves nothing behind.
bool starts_whole(const TempFolder& folder, std::vector<std::string> command,
                  const std::string& name) {
  const auto program = under(folder, command, name, on_any_port(folder, name));
  std::string rest;
  while (program->running() && !program->printed("READY", rest)) {
    sleep_until(monotonic_now() + 2 * kMillisecond);
  }
  const bool ready = program->running();
  if (ready) program->send(SIGTERM);
  const int code = program->finish();
  const std::string how = name + " under " + command.back() + ": " + program->output();
  if (ready) {
    EXPECT_EQ(code, 0) << how;
  } else if (code != -SIGABRT || says_its_version(folder, command, name)) {
    EXPECT_THAT(code, AnyOf(1, 2, 127)) << how;
    EXPECT_THAT(program->output(),
                AnyOf(HasSubstr("Too many open files"), HasSubstr("not enough memory"),
                      HasSubstr("temporarily unavailable"), HasSubstr("Cannot allocate memory"),
                      HasSubstr("out of memory"),  // of the loader, too
                      HasSubstr("error while loading shared libraries")))
        << how;
  }
  const bool clean = !std::filesystem::exists(folder.path() + "/op") ||
                     std::filesystem::is_empty(folder.path() + "/op");
  EXPECT_TRUE(clean) << how;
  return ready;
}

TEST(ScarceStart, WithFewDescriptorsAProgramStartsWholeOrSaysSo) {
  TempFolder folder;
  for (const char* name : kPrograms) {
    int started = 0;
    for (int most = 4; most <= 24; ++most) {
      const std::string n = std::to_string(most);
      started += starts_whole(folder, {"/usr/bin/prlimit", "--nofile=" + n + ":" + n}, name);
      if (HasFailure()) return;
    }
    EXPECT_GT(started, 0) << name;
    EXPECT_LT(started, 21) << name;
  }
}

TEST(ScarceStart, WithLittleMemoryAProgramStartsWholeOrSaysSo) {
  TempFolder folder;
  for (const char* name : kPrograms) {
    int started = 0;
    for (long most = 16 << 20; most <= 512 << 20; most += most / 16) {
      started += starts_whole(folder, {"/usr/bin/prlimit", "--as=" + std::to_string(most)}, name);
      if (HasFailure()) return;
    }
    EXPECT_GT(started, 0) << name;
  }
}
#endif

TEST(ScarceStart, AFolderThatCannotBeWrittenIsNamed) {
  TempFolder folder;
  const std::string place = folder.path() + "/fixed";
  std::filesystem::create_directory(place);
  const std::vector<std::string> command = {
      "/usr/bin/unshare",
      "-m",
      "/bin/sh",
      "-c",
      "mount -t tmpfs -o ro none " + place + " && exec \"$@\"",
      "sh"};
  Program tried(folder, command[0], {"-m", "/bin/sh", "-c", "mount -t tmpfs -o ro none " + place});
  if (tried.finish() != 0) GTEST_SKIP() << "nothing can be mounted here";
  const auto master =
      under(folder, command, "handrail-master",
            "link_socket: '" + folder.path() + "/link.sock' operator_socket: '" + place + "/op/s'");
  EXPECT_EQ(master->finish(), 2);
  EXPECT_THAT(master->output(), HasSubstr(place + "/op: Read-only file system"));
  const auto rig = under(folder, command, "handrail-rig",
                         "robot_port: 0 sensor_port: 0 tap: '" + place + "/rig.tap'");
  EXPECT_EQ(rig->finish(), 2);
  EXPECT_THAT(rig->output(), HasSubstr(place + "/rig.tap: Read-only file system"));
}

class ScarceCell : public WholeCell {
 protected:
  static constexpr const char* kPrlimit = "/usr/bin/prlimit";

  // Idle ones, who stay.
  void crowd(std::size_t count) {
    pb::Request request;
    request.set_status(true);
    for (std::size_t i = 0; i < count; ++i) {
      (void)clients_.emplace_back(socket()).call(request, kPatience);
    }
  }
  void limit_master(__rlimit_resource what, rlim_t most) {
    rlimit limit{};
    ASSERT_EQ(::prlimit(master->pid(), what, nullptr, &limit), 0);
    limit.rlim_cur = most;
    ASSERT_EQ(::prlimit(master->pid(), what, &limit, nullptr), 0);
  }
  void stop_acts() {
    EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
    order("reset: true");
    ASSERT_TRUE(slave_reaches("off"));
  }
  int lines_with(Program& program, const std::string& text) {
    const std::string said = program.output();
    int count = 0;
    for (std::size_t at = 0; (at = said.find(text, at)) != said.npos; ++at) ++count;
    return count;
  }

 private:
  std::list<OperatorClient> clients_;
};

TEST_F(ScarceCell, APortInUseIsNamedByTheRig) {
  for (const bool robots : {true, false}) {
    const std::string port = std::to_string(robots ? robot_port : sensor_port);
    const auto second = launch("handrail-rig", robots ? "sensor_port: 0 robot_port: " + port
                                                      : "robot_port: 0 sensor_port: " + port);
    EXPECT_EQ(second->finish(), 2);
    EXPECT_THAT(second->output(), HasSubstr((robots ? "robot port " : "sensor port ") +
                                            ("127.0.0.1:" + port) + " is in use"));
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(ScarceCell, WithoutDescriptorsWhoIsThereAndAStopAreServed) {
  const auto open =
      std::filesystem::directory_iterator("/proc/" + std::to_string(master->pid()) + "/fd");
  const auto count = std::distance(std::filesystem::begin(open), std::filesystem::end(open));
  limit_master(RLIMIT_NOFILE, static_cast<rlim_t>(count + 4));
  order("engage: true");
  crowd(30);
  EXPECT_EQ(handrail({"stop"}).first, 0);
  EXPECT_EQ(handrail({"reset"}).first, 0);
  stop_acts();
  EXPECT_EQ(lines_with(*master, "operators: no room for more than"), 1);
}

// Half-sent requests of the largest size, with what the master has left to hold them in.
TEST_F(ScarceCell, WithoutMemoryWhileItRunsAStopActs) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  std::ifstream statm("/proc/" + std::to_string(master->pid()) + "/statm");
  rlim_t pages = 0;
  statm >> pages;
  limit_master(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)));
  const std::string half = std::string("\0\0\1\0", 4) + std::string(60'000, 'x');
  std::list<RawClient> greedy;
  for (int i = 0; i < 400; ++i) (void)greedy.emplace_back(socket()).send(half);
  ASSERT_TRUE(eventually([&](const pb::Status&) {
    return lines_with(*master, "memory is short") > 0;
  })) << "there was enough";
  stop_acts();
  EXPECT_EQ(lines_with(*master, "memory is short"), 1);
  EXPECT_LE(lines_with(*master, "no memory left"), 1);
  limit_master(RLIMIT_AS, RLIM_INFINITY);
  order("engage: true");
  EXPECT_TRUE(slave_reaches("engaged"));
}
#endif

// All three programs under one command.
class CellUnder : public ScarceCell {
 protected:
  void start_under(const std::vector<std::string>& command) {
    rig =
        under(folder, command, "handrail-rig", "robot_port: 0 sensor_port: 0 repeatability_mm: 0");
    robot_port = rig->number_after("READY robot_port=");
    sensor_port = rig->number_after(" sensor_port=");
    slave = under(folder, command, "handrail-slave",
                  "link_socket: '" + link_socket + "' robot { port: " + std::to_string(robot_port) +
                      " } force_sensor { port: " + std::to_string(sensor_port) + " }");
    (void)slave->after("READY link=");
    master = under(folder, command, "handrail-master", master_config());
    (void)master->after("READY link=");
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
  void expect_to_follow(const std::string& by_mm) {
    order("engage: true");
    ASSERT_TRUE(slave_reaches("engaged"));
    const Vec3 start = mm(status().slave_command());
    const pb::Status last = move_hand(by_mm);
    EXPECT_GT((mm(last.slave_command()) - start).norm(), 5.0);
  }
};

class WithoutRealTime : public CellUnder {
 protected:
  void SetUp() override {
    start_under({kPrlimit, "--rtprio=0:0", "--memlock=65536:65536", "/usr/bin/setpriv",
                 "--bounding-set=-sys_nice,-ipc_lock,-sys_resource"});
  }
};

TEST_F(WithoutRealTime, TheArmFollowsAndItIsSaidOnce) {
  expect_to_follow("0, 20, 0");
  for (Program* program : {master.get(), slave.get()}) {
    EXPECT_EQ(lines_with(*program, "not in real time"), 1);
    EXPECT_EQ(lines_with(*program, "ordinary scheduling"), 2) << "of two threads";
  }
}

TEST_F(ScarceCell, WithEveryProcessorBusyTheProgramsGoOn) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  std::atomic<bool> busy{true};
  std::vector<std::thread> others;
  for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i) {
    others.emplace_back([&busy] {
      while (busy.load(std::memory_order_relaxed)) {
      }
    });
  }
  order("hand { displacement_mm: [0, 20, 0] duration_s: 1 }");
  sleep_until(monotonic_now() + 3 * kSecond);
  const Nanos asked = monotonic_now();
  EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
  EXPECT_LT(monotonic_now() - asked, kSecond);
  busy = false;
  for (std::thread& other : others) other.join();
  order("reset: true");
  ASSERT_TRUE(slave_reaches("off"));
  order("engage: true");
}

// Its clock says that the machine has run for a day longer; the calendar is nobody's business.
TEST_F(ScarceCell, ASlaveWithAnotherClockFollows) {
  Program tried(folder, "/usr/bin/unshare", {"-T", "--monotonic=86400", "/bin/true"});
  if (tried.finish() != 0) GTEST_SKIP() << "no clock can be shifted here";
  slave->send(SIGTERM);
  ASSERT_EQ(slave->finish(), 0);
  slave = under(folder, {"/usr/bin/unshare", "-T", "--monotonic=86400", "--boottime=86400"},
                "handrail-slave",
                "link_socket: '" + link_socket + "' robot { port: " + std::to_string(robot_port) +
                    " } force_sensor { port: " + std::to_string(sensor_port) + " }");
  (void)slave->after("READY link=");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() < 20.0; }));
  ASSERT_TRUE(slave_reaches("off"));
  if (status().state() == "fault") order("reset: true");
  ASSERT_TRUE(eventually([this](const pb::Status& s) {
    return s.state() == "engaged" || ask("engage: true").done();
  }));
  ASSERT_TRUE(slave_reaches("engaged"));
  const Vec3 start = mm(status().slave_command());
  const pb::Status last = move_hand("0, 20, 0");
  EXPECT_GT((mm(last.slave_command()) - start).norm(), 5.0);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
class LeapingCalendar : public CellUnder {
 protected:
  void SetUp() override { start_under({"/usr/bin/env", "LD_PRELOAD=" LEAPING_CALENDAR}); }
  // Those of the lines that a program has logged: "[2026-11-24 15:04:05.678] ...".
  static std::set<std::string> hours(const Program& program) {
    std::set<std::string> out;
    std::istringstream said(program.output());
    for (std::string line; std::getline(said, line);) {
      if (line.starts_with('[') && line.size() > 13) out.insert(line.substr(12, 2));
    }
    return out;
  }
};

TEST_F(LeapingCalendar, OnlyTheLogsTimesLeap) {
  for (int i = 0; i < 10; ++i) {
    expect_to_follow(i % 2 == 0 ? "0, 20, 0" : "0, -20, 0");
    stop_acts();
    ASSERT_FALSE(HasFailure());
  }
  for (const Program* program : {master.get(), slave.get()}) {
    EXPECT_GT(hours(*program).size(), 1u) << program->output();
  }
}
#endif

}  // namespace
}  // namespace handrail
