// A program of the build, run by a test: what it printed, and how it ended.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace handrail {

// A child whose failures are the test's.
class Program : public Child {
 public:
  // No test needs that long, whatever else the machine does.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static constexpr Nanos kPatience = 240 * kSecond;  // programs with checks put in are slow
#else
  static constexpr Nanos kPatience = 30 * kSecond;
#endif

  // `name`, `streams`: as a child's.
  Program(const TempFolder& folder, const std::string& name, std::vector<std::string> arguments,
          const Streams& streams = {})
      : Child(name, std::move(arguments), output_path(folder, name), false, streams) {
    EXPECT_EQ(start_error(), 0) << "cannot start " << path();
  }

  // Waits for `part` in the output; what follows it up to the line's end, "" when it never comes.
  std::string after(const std::string& part) {
    const Nanos give_up = monotonic_now() + kPatience;
    for (std::string rest;;) {
      const bool ended = !running();
      if (printed(part, rest)) return rest;
      if (ended || monotonic_now() > give_up) break;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << "no '" << part << "' in: " << output();
    return "";
  }
  // The number that follows `part`; 0 when there is none.
  int number_after(const std::string& part) { return std::atoi(after(part).c_str()); }

  // Waits for the end: the exit code, or minus the signal that ended it.
  int finish() {
    const Nanos give_up = monotonic_now() + kPatience;
    while (running()) {
      if (monotonic_now() > give_up) {
        ADD_FAILURE() << "does not end; printed: " << output();
        send(SIGKILL);
      }
      sleep_until(monotonic_now() + 2 * kMillisecond);
    }
    return code();
  }
  void kill() {
    send(SIGKILL);
    EXPECT_EQ(finish(), -SIGKILL);
  }

 private:
  static std::string output_path(const TempFolder& folder, const std::string& name) {
    static int count = 0;
    return folder.path() + "/" + name.substr(name.rfind('/') + 1) + "-" + std::to_string(++count) +
           ".out";
  }
};

}  // namespace handrail
