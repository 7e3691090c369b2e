#include "server/daemon/run_daemon.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <string>

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

// Who says so where an exception can reach no handler.
std::string running_program;
std::terminate_handler usual_end = nullptr;

// Functions of libraries that must not throw end the program where they find no memory; protobuf's
// descriptors are built in one.
[[noreturn]] void end_by_an_exception() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    complain(running_program, "not enough memory");
    std::_Exit(kFailed);
  } catch (...) {
  }
  usual_end();
  std::abort();
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
  running_program = program;
  usual_end = std::set_terminate(end_by_an_exception);
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
