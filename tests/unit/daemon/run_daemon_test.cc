#include "server/daemon/run_daemon.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <new>
#include <system_error>

namespace handrail {
namespace {

using ::testing::HasSubstr;

TEST(RunDaemon, PassesTheCodeOn) {
  EXPECT_EQ(run_daemon("handrail-x", [] { return 7; }), 7);
}

TEST(RunDaemon, SaysWhatTheSystemRefuses) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run_daemon("handrail-x", []() -> int { throw std::bad_alloc(); }), 1);
  EXPECT_EQ(run_daemon(
                "handrail-x",
                []() -> int { throw std::system_error(EMFILE, std::generic_category(), "epoll"); }),
            1);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("handrail-x: the system refuses what it needs: not enough memory"));
  EXPECT_THAT(said, HasSubstr("epoll: Too many open files"));
}

TEST(RunDaemon, WorkLeftBehindDoesNotKeepTheProcess) {
  const auto run = [] {
    return run_daemon("handrail-x", [] {
      Errand<Status> errand;
      (void)errand.poll([] {
        ::sleep(20);
        return Status::ok();
      });
      return 3;
    });
  };
  // In a process of its own from the start: TSan starts no thread in the copy of one with threads.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(::exit(run()), ::testing::ExitedWithCode(3), "");
}

}  // namespace
}  // namespace handrail
