// Preloaded into a program: a calendar that leaps an hour ahead and back, ten times a second. All
// other clocks are as they are.
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

namespace {

constexpr time_t kLeap = 3600;
constexpr long kPeriod = 100'000'000;  // [ns]

bool of_the_calendar(clockid_t clock) {
  return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI;
}

timespec leapt(timespec now) {
  if (now.tv_nsec / (kPeriod / 2) % 2 == 1) now.tv_sec += kLeap;
  return now;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* out) noexcept {
  const long code = ::syscall(SYS_clock_gettime, clock, out);
  if (code == 0 && of_the_calendar(clock)) *out = leapt(*out);
  return static_cast<int>(code);
}

extern "C" int gettimeofday(timeval* __restrict out, void* __restrict) noexcept {
  timespec now{};
  const int code = clock_gettime(CLOCK_REALTIME, &now);
  *out = {now.tv_sec, now.tv_nsec / 1000};
  return code;
}

extern "C" time_t time(time_t* out) noexcept {
  timespec now{};
  (void)clock_gettime(CLOCK_REALTIME, &now);
  if (out != nullptr) *out = now.tv_sec;
  return now.tv_sec;
}
