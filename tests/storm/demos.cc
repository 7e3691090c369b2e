#include "tests/storm/demos.h"

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/random.h"
#include "tests/storm/cell.h"

namespace handrail::storm {
namespace {

// To engage (2 s), lead the arm back (one to four moves of the hand, 3.3 s each) and repeat a move
// takes 9 to 18 s. Pauses in neighbouring windows of 20 s are 0 to 40 s apart, three in five of
// them over 18 s. That eleven in a row are closer, at which the demo gives up, is chance in one of
// twenty thousand moves.
constexpr Nanos kWindow = 20 * kSecond;
constexpr Nanos kShortest = 20 * kMillisecond, kLongest = 500 * kMillisecond;
constexpr Nanos kDemoPatience = 600 * kSecond;  // ten repeated moves, and a busy machine
constexpr Who kDemoPrograms[] = {Who::kRig, Who::kSlave, Who::kMaster};

Nanos between(Random& random, Nanos low, Nanos high) {
  return low + static_cast<Nanos>(random.uniform() * static_cast<double>(high - low));
}

}  // namespace

DemoOutcome run_demo(std::uint64_t seed, bool (*interrupted)()) {
  DemoOutcome out;
  Sequence calm;
  calm.seed = seed;
  Cell cell(calm, true);
  for (const Who who : kDemoPrograms) {
    if (const Status started = cell.start(who); !started) {
      out.complete = true;
      out.problem = started.message();
      return out;
    }
  }
  Child demo("handrail", {"demo", "--socket", cell.socket()}, cell.folder().path() + "/demo.out",
             true);
  Random random(seed);
  const Nanos start = monotonic_now();
  Nanos window = start, next = start + between(random, 0, kWindow);
  while (demo.running()) {
    if (interrupted()) return out;
    const Nanos now = monotonic_now();
    if (now - start > kDemoPatience) break;
    if (now >= next) {
      const Who who = kDemoPrograms[static_cast<std::size_t>(random.uniform() * 3.0) % 3];
      cell.pause(who);
      sleep_until(now + between(random, kShortest, kLongest));
      cell.resume(who);
      ++out.pauses;
      window += kWindow;
      next = window + between(random, 0, kWindow);
    }
    sleep_until(monotonic_now() + 2 * kMillisecond);
  }
  out.complete = true;
  std::string rest;
  if (demo.running()) {
    out.problem = "the demo does not end";
  } else if (demo.code() != 0) {
    out.problem = "the demo ended with " + std::to_string(demo.code());
  } else if (!demo.printed("largest orientation error", rest)) {
    out.problem = "the demo printed no table";
  }
  for (const Who who : kDemoPrograms) {
    if (!cell.running(who)) out.problem += std::string("; ") + name(who) + " does not run any more";
  }
  if (out.problem.empty()) return out;
  out.problem += "; it printed:\n" + demo.output();
  for (const Who who : kDemoPrograms)
    out.problem += std::string(name(who)) + ":\n" + cell.output(who);
  return out;
}

}  // namespace handrail::storm
