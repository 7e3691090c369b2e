// handrail-netfault: two commands on two sides of a bad network.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "server/base/output.h"
#include "server/base/signals.h"
#include "server/base/version.h"
#include "tests/emulator/netfault_args.h"
#include "tests/emulator/order_desk.h"
#include "tests/emulator/orders.h"
#include "tests/emulator/report.h"

namespace {

using namespace handrail;
using namespace handrail::emulator;

enum Exit { kDone = 0, kFailed = 1, kUsage = 2, kNotHere = 77, kStopped = 130 };

constexpr Nanos kToEnd = 2 * kSecond;  // for programs to end once they are asked, or killed
constexpr const char* kMain = "main";

int complain(const std::string& text, int code) {
  std::fprintf(stderr, "handrail-netfault: %s\n", text.c_str());
  return code;
}

// A descriptor that has something to read once the user or the system wants this to end.
int ending_descriptor() {
  sigset_t endings;
  sigemptyset(&endings);
  for (const int signal : ending_signals()) sigaddset(&endings, signal);
  ::sigprocmask(SIG_BLOCK, &endings, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return ::signalfd(-1, &endings, SFD_CLOEXEC | SFD_NONBLOCK);
}

// The command of a side; nullptr: it has none.
const SideProgram* main_of(Emulator& emulator, Side side) {
  const auto& programs = emulator.side(side).programs();
  const auto found = programs.find(kMain);
  return found == programs.end() ? nullptr : &found->second;
}

bool is_over(Emulator& emulator, Until until) {
  const SideProgram* const near = main_of(emulator, Side::kNear);
  const SideProgram* const far = main_of(emulator, Side::kFar);
  const bool near_over = near != nullptr && near->ended;
  const bool far_over = far != nullptr && far->ended;
  switch (until) {
    case Until::kNear: return near_over;
    case Until::kFar: return far_over;
    case Until::kAny: return near_over || far_over;
    case Until::kBoth:
      return (near != nullptr || far != nullptr) && (near == nullptr || near_over) &&
             (far == nullptr || far_over);
  }
  return true;
}

// Whether those that have ended ended well. Says so of those that did not.
bool ended_well(Emulator& emulator) {
  bool out = true;
  for (const Side side : {Side::kNear, Side::kFar}) {
    const SideProgram* const program = main_of(emulator, side);
    if (program == nullptr || !program->ended || program->good()) continue;
    (void)complain(std::string(name_of(side)) + ": " + program->ending(), 0);
    out = false;
  }
  return out;
}

bool any_runs(Emulator& emulator) {
  for (const Side side : {Side::kNear, Side::kFar}) {
    for (const auto& [name, program] : emulator.side(side).programs()) {
      if (!program.ended) return true;
    }
  }
  return false;
}

// Asks what still runs to end, gives it time to, and then does not ask any more.
void end_programs(Emulator& emulator) {
  for (const int number : {SIGTERM, SIGKILL}) {
    for (const Side side : {Side::kNear, Side::kFar}) {
      for (const auto& [name, program] : emulator.side(side).programs()) {
        if (program.ended) continue;
        emulator.side(side).signal(name, number);
        emulator.side(side).signal(name, SIGCONT);
      }
    }
    const Nanos give_up = emulator.now() + kToEnd;
    while (any_runs(emulator) && emulator.now() < give_up && emulator.turn({}, give_up)) {
    }
  }
}

// Until it is over: the exit code.
int pass(Emulator& emulator, const NetfaultArgs& args, OrderDesk& desk, int endings) {
  Orders orders(emulator, args.options.plan);
  while (!is_over(emulator, args.until) && !orders.ended()) {
    std::vector<pollfd> waits = desk.waits();
    waits.push_back({endings, POLLIN, 0});
    if (!emulator.turn(waits, kForever)) return complain("a side has ended by itself", kFailed);
    if (waits.back().revents != 0) return complain("stopped", kStopped);
    waits.pop_back();
    desk.serve(waits, [&](const std::string& line) { return orders.carry_out(line); });
  }
  return ended_well(emulator) ? kDone : kFailed;
}

int run(const std::vector<std::string>& words) {
  const Result<NetfaultArgs> args = read_args(words);
  if (!args) return complain(args.message(), kUsage);
  if (args->help) {
    std::fputs(usage().c_str(), stdout);
    return kDone;
  }
  OrderDesk desk;
  if (const Status open = desk.open(args->orders); !open) return complain(open.message(), kUsage);
  const int endings = ending_descriptor();
  Emulator emulator;
  if (const Status started = emulator.start(args->options); !started) {
    return complain("this machine does not allow " + started.message() +
                        "; what runs without: the same networks in virtual time, handrail-lab "
                        "faults --row N1",
                    kNotHere);
  }
  if (!args->taps.empty()) {
    if (const Status taps = emulator.record(args->taps, args->tap_bytes); !taps) {
      return complain(taps.message(), kUsage);
    }
  }
  for (const Side side : {Side::kNear, Side::kFar}) {
    const auto& command = side == Side::kNear ? args->near : args->far;
    if (command.empty()) continue;
    if (const Status ran = emulator.run(side, kMain, command); !ran) {
      return complain(ran.message(), kUsage);
    }
  }
  int code = pass(emulator, *args, desk, endings);
  end_programs(emulator);
  const Report report = emulator.report();
  if (const Status closed = emulator.close(); !closed) code = complain(closed.message(), kFailed);
  std::fputs((args->json ? to_json(report) + "\n" : for_people(report)).c_str(), stdout);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-netfault", argc, argv)) return 0;
  return handrail::end_output("handrail-netfault", run({argv + 1, argv + argc}));
}
