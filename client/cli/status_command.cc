#include "client/cli/status_command.h"

#include <poll.h>

#include "client/cli/interrupt.h"
#include "client/cli/status_view.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

constexpr int kRefreshMs = 200;
constexpr Nanos kPatience = 2 * kSecond;

// `last`: what was shown before, for those who show changes only.
void show(const pb::Status& status, const Options& options, const Console& console,
          std::string& /*last*/) {
  if (options.json) {
    console.out << json_text(status, !options.watch) << '\n';
    return;
  }
  // Home, then clear what is left of the last screen.
  if (options.watch && console.is_terminal) console.out << "\033[H\033[J";
  console.out << (console.is_terminal ? status_text(status, kTerminalRows) : status_text(status));
  if (options.watch && !console.is_terminal) console.out << '\n';
}

// On a terminal in place; elsewhere a line for each change.
void explain(const pb::Status& status, const Options& options, const Console& console,
             std::string& last) {
  if (options.json) {
    console.out << json_text(status.ledger(), !options.watch) << '\n';
    return;
  }
  const std::string text = why_text(status.ledger());
  if (options.watch && console.is_terminal) console.out << "\033[H\033[J";
  if (options.watch && !console.is_terminal && text == last) return;
  last = text;
  console.out << text << '\n';
}

using Show = void (*)(const pb::Status&, const Options&, const Console&, std::string&);

ExitCode poll_status(const Options& options, const Console& console, Show show_it) {
  OperatorClient client(options.master, options.as);
  pb::Request request;
  request.set_status(true);
  if (options.watch) catch_interrupts();
  std::string last;
  do {
    const Result<pb::Reply> reply = client.call(request, kPatience);
    if (options.watch && interrupted()) break;
    const ExitCode code = exit_code(reply);
    if (code != kExitDone) {
      console.err << "handrail: " << (reply ? "refused: " + reply->reason() : reply.message())
                  << '\n';
      return code;
    }
    show_it(reply->status(), options, console, last);
    console.out.flush();
    if (!console.out) {
      if (options.watch && interrupted()) drop_output();
      return kExitDone;
    }
    if (options.watch) ::poll(nullptr, 0, kRefreshMs);
  } while (options.watch && !interrupted());
  return kExitDone;
}

}  // namespace

ExitCode run_status(const Options& options, const Console& console) {
  return poll_status(options, console, show);
}

ExitCode run_why(const Options& options, const Console& console) {
  return poll_status(options, console, explain);
}

}  // namespace handrail
