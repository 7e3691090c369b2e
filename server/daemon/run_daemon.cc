#include "server/daemon/run_daemon.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>

#include "server/base/output.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

void complain(const std::string& program, const char* why) {
  take_endings();
  std::fprintf(stderr,
               "%s: the system refuses what it needs: %s; `ulimit -a` shows the limits it has\n",
               program.c_str(), why);
}

// glibc looks for a library the first time that an exception passes one of its own functions, as in
// std::call_once, and ends the program where there is no memory for it then (sysdeps/generic/
// unwind-resume.c). Protobuf builds its descriptors in one.
void have_exceptions_pass_glibc() {
  std::once_flag once;
  try {
    std::call_once(once, [] { throw std::bad_alloc(); });
  } catch (const std::bad_alloc&) {
  }
}

}  // namespace

void Announcement::make(const std::string& line) {
  (void)errand_.poll([text = line + "\n"] {
    const int error = write_all(STDOUT_FILENO, text);
    return error == 0 ? Status::ok() : Status::error(std::strerror(error));
  });
}

int fail_start(const std::string& program, const std::string& why) {
  take_endings();
  std::fprintf(stderr, "%s: %s\n", program.c_str(), why.c_str());
  return kBadInput;
}

int run_daemon(const std::string& program, const std::function<int()>& work) {
  int code = kFailed;
  try {
    have_exceptions_pass_glibc();
    code = work();
  } catch (const std::bad_alloc&) {
    complain(program, "not enough memory");
  } catch (const std::exception& refused) {
    complain(program, refused.what());
  }
  // Its thread may still use what exit() would destroy.
  if (errand_left_behind.load()) std::_Exit(code);
  return code;
}

}  // namespace handrail
