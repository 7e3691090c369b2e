#include "server/daemon/run_daemon.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

namespace handrail {
namespace {

constexpr int kFailed = 1;

Status write_out(const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(STDOUT_FILENO, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return Status::error(std::strerror(errno));
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return Status::ok();
}

void complain(const std::string& program, const char* why) {
  std::fprintf(stderr,
               "%s: the system refuses what it needs: %s; `ulimit -a` shows the limits it has\n",
               program.c_str(), why);
}

}  // namespace

void Announcement::make(const std::string& line) {
  (void)errand_.poll([text = line + "\n"] { return write_out(text); });
}

int run_daemon(const std::string& program, const std::function<int()>& work) {
  int code = kFailed;
  try {
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
