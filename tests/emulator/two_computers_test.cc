// The lines of the README's "Two computers", typed into shells of two sides that have nothing in
// common but a network: from the programs to an arm that moves.
#include <google/protobuf/util/json_util.h>
#include <sys/stat.h>

#include <functional>

#include "proto/operator.pb.h"
#include "server/base/spatial.h"
#include "tests/emulator/netfault_bench.h"

namespace handrail::emulator {
namespace {

// A line of the page: whose computer it is typed at, and what.
struct TypedLine {
  bool at_arm = false;
  std::string text;
};

// Those of the README below "## Two computers", without what a '#' says of them.
std::vector<TypedLine> lines_of_the_page() {
  std::ifstream page(HANDRAIL_SOURCE_DIR "/README.md");
  std::string row;
  while (std::getline(page, row) && row != "## Two computers") {
  }
  std::vector<TypedLine> out;
  while (std::getline(page, row) && !row.starts_with("## ")) {
    for (const std::string prompt : {"    arm$  ", "    desk$ "}) {
      if (!row.starts_with(prompt)) continue;
      std::string text = row.substr(prompt.size(), row.find(" #") - prompt.size());
      text.erase(text.find_last_not_of(' ') + 1);
      out.push_back({prompt.find("arm") != std::string::npos, text});
    }
  }
  return out;
}

// Puts `what` in the place of `name`, if it is there.
std::string with(const std::string& text, const std::string& name, const std::string& what) {
  const std::size_t at = text.find(name);
  if (at == std::string::npos) return text;
  return text.substr(0, at) + what + text.substr(at + name.size());
}

// A shell on a side of the emulator, which reads what is typed from a pipe in the shared folder.
class Typist {
 public:
  Typist(std::string pipe, std::function<std::string()> printed)
      : pipe_(std::move(pipe)), printed_(std::move(printed)) {
    EXPECT_EQ(::mkfifo(pipe_.c_str(), 0600), 0);
    fd_ = ::open(pipe_.c_str(), O_RDWR | O_CLOEXEC);  // both ends: there may be no reader yet
  }
  ~Typist() { ::close(fd_); }
  Typist(const Typist&) = delete;
  Typist& operator=(const Typist&) = delete;

  // The shell with nothing of ours but the programs' folder.
  Words shell() const {
    return {"env",
            "-u",
            "HANDRAIL_KEYS",
            "-u",
            "HANDRAIL_SOCKET",
            "-u",
            "XDG_CONFIG_HOME",
            std::string("PATH=") + HANDRAIL_BIN_DIR + ":/usr/bin:/bin",
            "bash",
            "-c",
            "exec bash --norc -s < " + pipe_};
  }
  void give(const std::string& line) const {
    const std::string text = line + "\n";
    EXPECT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  // What follows `words` in all that was printed, to the end of its line; empty: it does not come.
  std::string line_after(const std::string& words) const {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    for (std::string all = printed_(); monotonic_now() < give_up; all = printed_()) {
      const std::size_t at = all.find(words);
      const std::size_t end = at == std::string::npos ? at : all.find('\n', at);
      if (end != std::string::npos) return all.substr(at + words.size(), end - at - words.size());
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << "not printed: " << words << "\n" << printed_();
    return {};
  }
  // Types it, and an answer to what it asks, and waits until it is done: what it printed, and its
  // exit code.
  std::pair<std::string, int> type(const std::string& line, const std::string& answer = {}) {
    const std::string mark = "done-" + std::to_string(++typed_) + ":";
    const std::size_t before = printed_().size();
    give(line);
    if (!answer.empty()) give(answer);
    give("echo " + mark + "$?");
    for (const Nanos give_up = monotonic_now() + Program::kPatience; monotonic_now() < give_up;) {
      const std::string all = printed_();
      const std::size_t end = all.find(mark, before);
      if (end != std::string::npos && all.find('\n', end) != std::string::npos) {
        return {all.substr(before, end - before), std::atoi(all.c_str() + end + mark.size())};
      }
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << line << ": does not end; printed: " << printed_();
    return {"", -1};
  }

 private:
  std::string pipe_;
  std::function<std::string()> printed_;
  int fd_ = -1;
  int typed_ = 0;
};

class TwoComputersTest : public NetfaultTest {
 protected:
  // Where the arm's tip is, as the master says [mm].
  Vec3 tip() {
    pb::Status status;
    const std::string json = desk_.type("handrail status --json").first;
    const auto read = google::protobuf::util::JsonStringToMessage(json, &status);
    EXPECT_TRUE(read.ok()) << json;
    if (status.tip().position_mm_size() != 3) return Vec3::Constant(1e6);
    return {status.tip().position_mm(0), status.tip().position_mm(1), status.tip().position_mm(2)};
  }
  // A line that a program is started with is done once the program is.
  void type(const TypedLine& line) {
    Typist& at = line.at_arm ? arm_ : desk_;
    const std::string name = line.at_arm ? "far-main" : "near-main";
    const std::size_t ready = count_of(printed(name), "READY ");
    if (line.text == "handrail keys pair slave") {
      at.give(line.text);  // it waits for the other side
      code_ = at.line_after("code: ");
      return;
    }
    const bool asks = line.text.find(" --with ") != std::string::npos;
    const auto [text, code] = at.type(line.text, asks ? code_ : std::string());
    EXPECT_EQ(code, 0) << line.text << "\n" << text;
    if (line.text.ends_with("&")) {
      const Nanos give_up = monotonic_now() + Program::kPatience;
      while (count_of(printed(name), "READY ") == ready) {
        ASSERT_LT(monotonic_now(), give_up) << line.text << "\n" << printed(name);
        sleep_until(monotonic_now() + 5 * kMillisecond);
      }
    }
    std::printf("%s$ %s\n", line.at_arm ? "arm" : "desk", line.text.c_str());
  }
  static std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
    return count;
  }
  std::string code_;  // that the arm shows, for the desk
  Typist arm_{folder_.path() + "/arm.pipe", [this] { return printed("far-main"); }};
  Typist desk_{folder_.path() + "/desk.pipe", [this] { return printed("near-main"); }};
};

TEST_F(TwoComputersTest, TheLinesOfTheReadmeMoveTheArm) {
  const std::vector<TypedLine> page = lines_of_the_page();
  ASSERT_GE(page.size(), 8u) << "lines 'arm$ ...' and 'desk$ ...' below '## Two computers'";
  EXPECT_LE(page.size(), 10u);
  const Words options = {"--seed",   "1",
                         "--set",    "both { delay_ms: 10 jitter_ms: 2 }",
                         "--share",  HANDRAIL_BIN_DIR,
                         "--share",  folder_.path(),
                         "--output", folder_.path(),
                         "--until",  "near"};
  Program netfault(
      folder_, "handrail-netfault",
      options + Words{"--", "near:"} + desk_.shell() + Words{"--", "far:"} + arm_.shell());
  Vec3 before = Vec3::Zero();
  for (TypedLine line : page) {
    line.text = with(line.text, "ARM", "10.77.0.2");
    if (line.text.find(" hand to ") != std::string::npos) before = tip();
    type(line);
    if (HasFatalFailure()) break;
  }
  const Nanos give_up = monotonic_now() + 10 * kSecond;
  double moved = 0.0;
  while (moved < 20.0 && monotonic_now() < give_up) moved = (tip() - before).norm();
  EXPECT_GT(moved, 20.0) << "[mm], of 81 that the hand asks for";
  std::printf("the arm's tip moved by %.1f mm\n", moved);
  EXPECT_EQ(count_of(printed("near-main"), "ok       link.peer: session with "), 1u);
  desk_.give("exit");
  EXPECT_EQ(netfault.finish(), 0) << netfault.output();
}

}  // namespace
}  // namespace handrail::emulator
