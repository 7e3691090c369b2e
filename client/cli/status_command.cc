#include "client/cli/status_command.h"

#include <poll.h>
#include <signal.h>

#include <atomic>

#include "client/cli/status_view.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

constexpr int kRefreshMs = 200;
constexpr Nanos kPatience = 2 * kSecond;

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = true; };
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

void show(const pb::Status& status, const Options& options, const Console& console) {
  if (options.json) {
    console.out << json_text(status, !options.watch) << '\n';
    return;
  }
  // Home, then clear what is left of the last screen.
  if (options.watch && console.is_terminal) console.out << "\033[H\033[J";
  console.out << status_text(status);
  if (options.watch && !console.is_terminal) console.out << '\n';
}

}  // namespace

ExitCode run_status(const Options& options, const Console& console) {
  OperatorClient client(options.socket, options.as);
  pb::Request request;
  request.set_status(true);
  interrupted = false;
  if (options.watch) catch_interrupts();
  do {
    const Result<pb::Reply> reply = client.call(request, kPatience);
    if (interrupted) break;
    const ExitCode code = exit_code(reply);
    if (code != kExitDone) {
      console.err << "handrail: " << (reply ? "refused: " + reply->reason() : reply.message())
                  << '\n';
      return code;
    }
    show(reply->status(), options, console);
    console.out.flush();
    if (!console.out) return kExitDone;
    if (options.watch) ::poll(nullptr, 0, kRefreshMs);
  } while (options.watch && !interrupted);
  return kExitDone;
}

}  // namespace handrail
