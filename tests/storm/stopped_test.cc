// The program itself, stopped in the middle of a sequence.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/storm/results.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace handrail::storm {
namespace {

using ::testing::HasSubstr;

constexpr Nanos kPatience = 20 * kSecond;  // on a busy machine
constexpr int kCancelled = 130;            // as of every program of the project

template <typename Condition>
bool wait_for(Condition condition) {
  const Nanos give_up = monotonic_now() + kPatience;
  while (!condition()) {
    if (monotonic_now() > give_up) return false;
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return true;
}

// Programs that were started with something from `folder`.
int running_with(const std::string& folder) {
  int found = 0;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    std::ostringstream text;
    text << std::ifstream(process.path() / "cmdline").rdbuf();
    found += text.str().find(folder) != std::string::npos ? 1 : 0;
  }
  return found;
}

TEST(StormProgram, StoppedInTheMiddleItEndsItsProgramsAndSaysHowToGoOn) {
  Outcome outcome;
  outcome.seconds = 1.0;
  const std::string done = to_line(line_of(draw(1), outcome)) + "\n";
  for (const int signal : {SIGINT, SIGTERM}) {
    const TempFolder folder, out;
    const std::string results = out.write("storm.tsv", done);
    ::setenv("TMPDIR", folder.path().c_str(), 1);
    Child storm("handrail-storm",
                {"--sequences", "3", "--seed", "1", "--results", results, "--keep", out.path()},
                out.path() + "/printed");
    ::unsetenv("TMPDIR");
    ASSERT_TRUE(wait_for([&] { return running_with(folder.path()) == 3; })) << storm.output();
    storm.send(signal);
    ASSERT_TRUE(wait_for([&] { return !storm.running(); }));
    EXPECT_EQ(storm.code(), kCancelled);
    EXPECT_EQ(running_with(folder.path()), 0);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_THAT(storm.output(), HasSubstr("stopped after 1 of 3 sequences, 0 violated; "
                                          "--sequences 3 --seed 1 --results " +
                                          results + " goes on"));
    std::ostringstream kept;
    kept << std::ifstream(results).rdbuf();
    EXPECT_EQ(kept.str(), done);
  }
}

}  // namespace
}  // namespace handrail::storm
