// handrail-netfault as the tests run it: with echo and ping on its sides, and orders over a socket.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "tests/emulator/report_text.h"
#include "tests/loopback/program.h"

namespace handrail::emulator {

using Words = std::vector<std::string>;

inline const char* const kEcho = HANDRAIL_BIN_DIR "/handrail-netfault-echo";

inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Whether this machine allows what the emulator needs, by another program.
inline bool has_namespaces(const TempFolder& folder) {
  const int tun = ::open("/dev/net/tun", O_RDWR | O_CLOEXEC);
  if (tun < 0) return false;
  ::close(tun);
  Words words = {"-n", "-m", "-i", "-p", "-f", "true"};
  if (::geteuid() != 0) words.insert(words.begin(), "-r");
  Program other(folder, "/usr/bin/unshare", words);
  return other.finish() == 0;
}

// Each test of real packets: skipped, with what the program says, where this machine allows none.
class NetfaultTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Program trial(folder_, "handrail-netfault", {"--", "near:", "true"});
    if (trial.finish() == 77 && !has_namespaces(folder_)) GTEST_SKIP() << trial.output();
    EXPECT_EQ(trial.code(), 0) << trial.output();
  }

  // Far serves; near pings once far does. What they print goes into the test's folder.
  Words echo_and_ping(const Words& options, const std::string& ping) const {
    return options + served() +
           Words{"--until",
                 "near",
                 "--",
                 "near:",
                 "sh",
                 "-c",
                 "sleep 0.3; exec " + std::string(kEcho) + " ping " + ping,
                 "--",
                 "far:",
                 kEcho,
                 "serve",
                 "7000"};
  }
  Words served() const {
    return {"--json", "--seed", "1", "--output", folder_.path(), "--share", HANDRAIL_BIN_DIR};
  }
  // Runs it to its end: the report.
  std::string run(const Words& words, int code = 0) {
    Program netfault(folder_, "handrail-netfault", words);
    EXPECT_EQ(netfault.finish(), code) << netfault.output();
    return netfault.output();
  }
  std::string printed(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() + "/" + name + ".out").rdbuf();
    return text.str();
  }
  // Waits for a program's output to have `part`.
  ::testing::AssertionResult prints(const std::string& name, const std::string& part) const {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (monotonic_now() < give_up) {
      if (printed(name).find(part) != std::string::npos) return ::testing::AssertionSuccess();
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    return ::testing::AssertionFailure() << "no '" << part << "' in: " << printed(name);
  }

  TempFolder folder_;
};

// A client that gives orders.
class Orderer {
 public:
  explicit Orderer(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::strncpy(to.sun_path, path.c_str(), sizeof to.sun_path - 1);
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
      if (monotonic_now() > give_up) {
        ADD_FAILURE() << path << ": nobody takes orders";
        return;
      }
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
  }
  ~Orderer() { ::close(fd_); }
  Orderer(const Orderer&) = delete;
  Orderer& operator=(const Orderer&) = delete;

  std::string order(std::string line) {
    line += "\n";
    (void)!::send(fd_, line.data(), line.size(), MSG_NOSIGNAL);
    std::string answer;
    for (char c = 0; ::recv(fd_, &c, 1, 0) == 1 && c != '\n';) answer += c;
    return answer;
  }
  // Waits until a count of the report has reached `least`: the report.
  std::string report_with(const std::string& direction, const std::string& name, double least) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    for (;;) {
      std::string report = order("report");
      if (count(report, direction, name) >= least) return report;
      if (monotonic_now() > give_up) {
        ADD_FAILURE() << direction << "." << name << " stays below " << least << ": " << report;
        return report;
      }
      sleep_until(monotonic_now() + 20 * kMillisecond);
    }
  }

 private:
  int fd_;
};

}  // namespace handrail::emulator
